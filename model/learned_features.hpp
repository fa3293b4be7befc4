#pragma once

#include "conelane/lane_graph_problem.hpp"
#include "conelane/learned_costs.hpp"

#include <functional>

namespace conelane {

inline constexpr std::size_t kEdgeFeatures = 15;
inline constexpr std::size_t kTurnFeatures = 14;
inline constexpr std::size_t kNearEndFeatures = 7;
inline constexpr std::size_t kFarEndFeatures = 6;

/// The features of a problem's edges, turns and ends; formulation.md has the definition of each. All are
/// continuous in the positions, so a checker with other arithmetic finds the same costs. Problem and scene
/// must outlive it. Preconditions: edges, their facing costs, facers and which cones are near are known; no
/// coordinate is farther than 1e5 m from the car.
class LearnedFeatures {
  public:
    /// `stop` is called with an amount of work before it is done. Once it returns true, results are invalid.
    LearnedFeatures(const Scene& scene, const LaneGraphProblem& problem,
                    const std::function<bool(std::size_t)>& stop = {});

    /// Precondition: the edge is not high_cost.
    [[nodiscard]] std::array<double, kEdgeFeatures> edge(std::size_t number) const;
    /// Precondition: neither edge is high_cost. `angle_cost`: of (20).
    [[nodiscard]] std::array<double, kTurnFeatures> turn(std::size_t edge_i, std::size_t edge_k,
                                                         std::size_t middle, double angle_cost) const;
    /// Precondition: the cone is near.
    [[nodiscard]] std::array<double, kNearEndFeatures> near_end(std::size_t cone) const;
    /// Precondition: the cone is far.
    [[nodiscard]] std::array<double, kFarEndFeatures> far_end(std::size_t cone) const;

  private:
    [[nodiscard]] const Point& at(std::size_t cone) const { return position_[cone]; }
    [[nodiscard]] double crowd(const Point& place, std::size_t without, std::size_t and_without) const;

    const Scene* scene_;
    const LaneGraphProblem* problem_;
    std::vector<Point> position_;     ///< of each cone, close together in memory
    std::vector<double> distance_m_;  ///< of each cone from the car
    std::vector<double> ahead_m_;
    double view_m_ = 0.0;  ///< how far the car sees
    std::vector<double> cone_crowd_;
    std::vector<double> facing_;                          ///< by edge, for a lane of any width
    std::vector<std::vector<std::size_t>> around_;        ///< cones within kAround_m of each
    std::vector<std::vector<std::size_t>> around_edges_;  ///< cones as near as the ends of the longest edge
};

}  // namespace conelane
