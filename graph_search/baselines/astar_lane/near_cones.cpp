#include "graph_search/baselines/astar_lane/near_cones.hpp"

#include <algorithm>
#include <cmath>

namespace conelane {

void NearCones::build(std::span<const Point> points, double reach_m, double radius_m) {
    reach_m_ = reach_m;
    const double fitting = std::floor(2.0 * reach_m / radius_m);
    cells_a_side_ = static_cast<std::int64_t>(std::clamp(fitting, 1.0, static_cast<double>(kMaxCells)));
    // The grid is a little wider than the reach, so that a point at the far end has a cell.
    cell_m_ = 2.0 * reach_m / static_cast<double>(cells_a_side_) * (1.0 + 1e-9);
    const auto number_of = [this](const Point& point) {
        const std::int64_t column = std::clamp<std::int64_t>(cell_of(point.x()), 0, cells_a_side_ - 1);
        const std::int64_t row = std::clamp<std::int64_t>(cell_of(point.y()), 0, cells_a_side_ - 1);
        return static_cast<std::size_t>(row * cells_a_side_ + column);
    };
    first_.assign(static_cast<std::size_t>(cells_a_side_ * cells_a_side_) + 1, 0);
    for (const Point& point : points) ++first_[number_of(point) + 1];
    for (std::size_t cell = 1; cell < first_.size(); ++cell) first_[cell] += first_[cell - 1];
    ordered_.resize(points.size());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (const Point& point : points) ordered_[next[number_of(point)]++] = point;
}

}  // namespace conelane
