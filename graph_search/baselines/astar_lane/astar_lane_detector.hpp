#pragma once

#include "conelane/lane_detector.hpp"
#include "graph_search/shared/parameter_field.hpp"
#include "graph_search/shared/search_budget.hpp"
#include "model/geometry.hpp"

#include <array>

namespace conelane {

/// A place on a path: its arc length and unit tangent.
struct PathSample {
    Point position;
    Point direction;
    double along_m;
};

/// Rules for reading boundaries off a path.
struct BoundaryReading {
    double nearest_m;      ///< a cone nearer to the path blocks it and is on no boundary
    double widest_side_m;  ///< a cone farther from the path is on no boundary
    double w_slope;        ///< weight of the squared slope against the path; each cone earns 1
};

/// Indices of points, in order along the path.
using PathBoundaries = std::array<std::vector<std::uint32_t>, 2>;

/// On each side of a path, the chain of points, ordered along the path, with the highest score: the number of
/// points less the weighted squared slopes between neighbours (distance from the path over distance along
/// it). Points before the first or beyond the last sample of the path are left out. Precondition: `path` is
/// not empty and ascending in along_m. Empty if the budget is spent before the end.
[[nodiscard]] PathBoundaries boundaries_along(std::span<const PathSample> path, std::span<const Point> points,
                                              const BoundaryReading& reading, SearchBudget& budget);

/// Finds the cones around a place, by a grid of square cells.
class NearCones {
  public:
    /// Precondition: every point is within `reach_m` of the origin. Cells are at least as wide as `radius_m`;
    /// there are at most kMaxCells in a row.
    void build(std::span<const Point> points, double reach_m, double radius_m);

    /// Calls `visit` with every point within the radius of `place`, and with some others. Returns their
    /// number.
    template <typename Visit>
    std::size_t visit_near(const Point& place, const Visit& visit) const {
        const std::int64_t column = cell_of(place.x());
        const std::int64_t row = cell_of(place.y());
        std::size_t visited = 0;
        for (std::int64_t r = row > 0 ? row - 1 : 0; r <= row + 1 && r < cells_a_side_; ++r) {
            const std::int64_t from = column > 0 ? column - 1 : 0;
            const std::int64_t to = column + 2 < cells_a_side_ ? column + 2 : cells_a_side_;
            if (from >= to) break;
            const std::size_t first = first_[static_cast<std::size_t>(r * cells_a_side_ + from)];
            const std::size_t last = first_[static_cast<std::size_t>(r * cells_a_side_ + to)];
            for (std::size_t i = first; i < last; ++i) visit(ordered_[i]);
            visited += last - first;
        }
        return visited;
    }

  private:
    static constexpr std::int64_t kMaxCells = 64;

    [[nodiscard]] std::int64_t cell_of(double coordinate) const {
        return static_cast<std::int64_t>((coordinate + reach_m_) / cell_m_);
    }

    double reach_m_ = 0.0;
    double cell_m_ = 1.0;
    std::int64_t cells_a_side_ = 0;
    std::vector<std::size_t> first_;  ///< by cell, row by row: its first point in `ordered_`
    std::vector<Point> ordered_;
};

/// The path search: what a path is, its cost, and how boundaries are read off it. Costs are relative to a
/// metre with no cone on one side, which costs 1.
struct AstarLaneParameters {
    double least_radius_m = 4.0;  ///< radius of the tightest turn of a path
    double horizon_m = 25.0;      ///< length of a path
    double w_end = 1.5;           ///< cost of each metre that a path is shorter than the horizon
    double w_turn = 0.1;          ///< weight of the squared curvature, 1 at the tightest turn
    double w_steer = 0.1;         ///< weight of the squared change of curvature between two steps
    double clearance_m = 1.6;     ///< distance from cones that a path prefers to keep
    double w_clearance = 4.0;     ///< weight of the squared missing share of the clearance
    double w_hit = 5.0;           ///< cost of a metre that is nearer to a cone than half the width of a car
    double window_m = 2.8;  ///< a cone up to this distance before or behind a point is beside the path there
    double widest_side_m = 4.0;     ///< a cone farther aside is not
    double expected_width_m = 4.0;  ///< distance between the nearest cones on the two sides
    double w_width = 0.3;           ///< weight of the squared error of this width [1/m^2]
    double w_slope = 4.0;    ///< weight of a boundary's squared slope against the path, relative to a cone
    double heuristic = 0.2;  ///< estimated cost of a metre ahead
    std::int64_t max_steps = 10'000;  ///< number of steps that the search expands, in [1, 1000000]
};

/// The tuned numbers, in the order of files.
[[nodiscard]] std::span<const ParameterField<AstarLaneParameters>> astar_lane_fields();

/// Throws InvalidInput naming the first parameter that is out of its range.
void validate(const AstarLaneParameters& parameters);

/// Lane detection by path planning, after Tanzmeister, Friedl, Lawitzky, Wollherr and Buss, "Road course
/// estimation in unknown, structured environments" (2013), reference [2] of the CLC paper. It searches a path
/// between the boundaries by A* over arcs of bounded curvature from the car's pose on (a lattice of
/// positions, headings and lengths). A path keeps away from cones; hitting a cone is expensive but allowed,
/// since it may be a false detection. A metre with cones on both sides, about a lane apart, costs least. The
/// boundaries are then read off the path: on each side, the chain of cones that runs along it most evenly.
///
/// The answer is the cheapest path whose boundaries have at least two cones each. Paths are taken in the
/// order of their costs, exactly so if `heuristic` underestimates. LaneAnswer::status: `none` if fewer than
/// four places have a cone in reach, or every path of the lattice was seen; `stopped` by iterations if none
/// of the paths seen has boundaries. If a limit cuts off the search, the answer is the best path so far. No
/// state is kept from scene to scene. Throws InvalidInput if a parameter is out of its range.
[[nodiscard]] std::unique_ptr<LaneDetector> make_astar_lane_detector(const AstarLaneParameters& parameters);

}  // namespace conelane
