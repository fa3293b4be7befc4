#pragma once

#include "graph_search/shared/search_budget.hpp"
#include "model/geometry.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace conelane {

/// A place on a path: how far along, and its unit tangent.
struct PathSample {
    Point position;
    Point direction;
    double along_m;
};

/// How boundaries are read off a path.
struct BoundaryReading {
    double nearest_m;      ///< a cone nearer to the path is in its way and on no boundary
    double widest_side_m;  ///< a cone farther from it is on none either
    double w_slope;        ///< weight of the squared slope against the path; each cone earns 1
};

/// Indices of points, along the path.
using PathBoundaries = std::array<std::vector<std::uint32_t>, 2>;

/// On each side of a path the chain of points, ordered along it, that has the most of them less the weighted
/// squared slopes between neighbours (distance from the path over distance along it). Points before the
/// path's first or beyond its last sample belong to none. Precondition: `path` is not empty, ascending in
/// along_m. Empty where the budget is spent before the end.
[[nodiscard]] PathBoundaries boundaries_along(std::span<const PathSample> path, std::span<const Point> points,
                                              const BoundaryReading& reading, SearchBudget& budget);

}  // namespace conelane
