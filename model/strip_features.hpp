#pragma once

#include "conelane/lane_graph_problem.hpp"
#include "model/strip_costs.hpp"

#include <compare>
#include <functional>

namespace conelane {

/// The features of the columns of a strip program. All are continuous in the positions, so a checker with
/// other arithmetic finds the same costs. Graph and scene must outlive it.
class StripFeatures {
  public:
    /// `reach_m`: no triangle has a longer side. `stop` is called for each cone; once it returns true,
    /// results are invalid.
    StripFeatures(const Scene& scene, const LaneGraphProblem& graph, double reach_m,
                  const std::function<bool()>& stop = {});

    [[nodiscard]] std::array<double, kStripEdgeFeatures> edge(std::size_t i, std::size_t j) const;
    /// Of the step of one boundary from a cone to the next, while the other boundary stays at `across`.
    /// `inside`: see inside_of.
    [[nodiscard]] std::array<double, kStripTriangleFeatures> triangle(std::size_t from, std::size_t to,
                                                                      std::size_t across,
                                                                      double inside) const;
    [[nodiscard]] std::array<double, kStripStartFeatures> start(std::size_t left, std::size_t right) const;
    /// Of the turn i, j, k. `lane_inside`: the lane lies in the angle that is below pi.
    [[nodiscard]] std::array<double, kStripTurnFeatures> turn(std::size_t i, std::size_t j, std::size_t k,
                                                              bool lane_inside) const;
    /// Of a boundary that ends at `to`.
    [[nodiscard]] std::array<double, kStripEndFeatures> end(std::size_t from, std::size_t to) const;
    /// The cones in the triangle of three cones: each counts up to 1, by its depth; at most 2.
    [[nodiscard]] double inside_of(std::size_t a, std::size_t b, std::size_t c) const;
    /// A cone relative to the car, in the axes of the map [m].
    [[nodiscard]] const Point& at(std::size_t cone) const { return at_[cone]; }

  private:
    [[nodiscard]] double crowd(const Point& place, std::size_t without, std::size_t and_without) const;

    std::vector<Point> at_;
    std::vector<double> ahead_m_;
    std::vector<double> left_m_;
    std::vector<double> distance_m_;
    std::vector<double> crowd_;  ///< at each cone
    struct Neighbour {
        double distance_m;
        std::size_t cone;
        auto operator<=>(const Neighbour&) const = default;
    };
    std::vector<std::vector<Neighbour>> around_;  ///< of each cone those within reach, the nearest first
    double view_m_ = 0.0;                         ///< how far the car sees
};

}  // namespace conelane
