#include "graph_search/baselines/astar_lane/path_boundaries.hpp"

#include "graph_search/shared/search_graph.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
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

}  // namespace conelane
