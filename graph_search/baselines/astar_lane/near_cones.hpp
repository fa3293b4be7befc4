#pragma once

#include "model/geometry.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace conelane {

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
