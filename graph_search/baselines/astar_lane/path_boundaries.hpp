#pragma once

#include "graph_search/shared/search_budget.hpp"
#include "model/geometry.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

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

}  // namespace conelane
