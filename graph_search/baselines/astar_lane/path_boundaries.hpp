#pragma once

#include "graph_search/shared/search_budget.hpp"
#include "model/geometry.hpp"

#include <array>
#include <cstddef>
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

}  // namespace conelane
