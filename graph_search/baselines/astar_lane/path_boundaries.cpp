#include "graph_search/baselines/astar_lane/path_boundaries.hpp"

#include "graph_search/shared/search_graph.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace conelane {
namespace {

/// Two points of a chain are at least this far apart along the path, so that the slope is finite.
constexpr double kMinAdvance_m = 0.1;

/// A point in the frame of the path.
struct Beside {
    double along_m;
    double across_m;  ///< from the path, on its side
    std::uint32_t point;
};

std::array<std::vector<Beside>, 2> sides_of(std::span<const PathSample> path, std::span<const Point> points,
                                            const BoundaryReading& reading) {
    std::array<std::vector<Beside>, 2> sides;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        const auto nearest = std::ranges::min_element(
            path, {}, [&](const PathSample& sample) { return (sample.position - points[i]).squaredNorm(); });
        const Point offset = points[i] - nearest->position;
        const double ahead_m = nearest->direction.dot(offset);
        if (offset.norm() < reading.nearest_m || offset.norm() > reading.widest_side_m) continue;
        const bool is_before = nearest == path.begin() && ahead_m < 0.0;
        const bool is_beyond = nearest + 1 == path.end() && ahead_m > 0.0;
        if (is_before || is_beyond) continue;
        const double across_m = cross(nearest->direction, offset);
        sides[across_m > 0.0 ? kLeft : kRight].push_back({nearest->along_m + ahead_m, std::abs(across_m), i});
    }
    for (std::vector<Beside>& side : sides) {
        std::ranges::sort(side, [](const Beside& a, const Beside& b) {
            return a.along_m != b.along_m ? a.along_m < b.along_m : a.point < b.point;
        });
    }
    return sides;
}

std::vector<std::uint32_t> best_chain(const std::vector<Beside>& side, double w_slope, SearchBudget& budget) {
    constexpr std::size_t kFirst = std::numeric_limits<std::size_t>::max();
    std::vector<double> worth(side.size());
    std::vector<std::size_t> before(side.size(), kFirst);
    for (std::size_t i = 0; i < side.size(); ++i) {
        if (budget.spend(1 + i)) return {};
        for (std::size_t j = 0; j < i; ++j) {
            const double advance_m = side[i].along_m - side[j].along_m;
            if (advance_m < kMinAdvance_m) continue;
            const double slope = (side[i].across_m - side[j].across_m) / advance_m;
            const double chained = worth[j] - w_slope * slope * slope;
            if (chained <= worth[i]) continue;
            worth[i] = chained;
            before[i] = j;
        }
        worth[i] += 1.0;
    }
    std::vector<std::uint32_t> chain;
    if (side.empty()) return chain;
    auto last = static_cast<std::size_t>(std::ranges::max_element(worth) - worth.begin());
    for (; last != kFirst; last = before[last]) chain.push_back(side[last].point);
    std::ranges::reverse(chain);
    return chain;
}

}  // namespace

PathBoundaries boundaries_along(std::span<const PathSample> path, std::span<const Point> points,
                                const BoundaryReading& reading, SearchBudget& budget) {
    if (budget.spend(points.size() * path.size() / 4)) return {};
    const std::array<std::vector<Beside>, 2> sides = sides_of(path, points, reading);
    return {best_chain(sides[kLeft], reading.w_slope, budget),
            best_chain(sides[kRight], reading.w_slope, budget)};
}

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
