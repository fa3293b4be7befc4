#include "evaluation/world/boundary_matching.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace conelane {
namespace {

enum class Step : std::uint8_t { both, left, right };

}  // namespace

std::vector<FacingPlaces> match_boundaries(std::span<const Point> left, std::span<const Point> right) {
    const std::size_t columns = right.size();
    std::vector<Step> steps(left.size() * columns, Step::both);
    std::vector<double> row(columns);
    std::vector<double> row_before(columns);
    constexpr double kNever = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < left.size(); ++i) {
        std::swap(row, row_before);
        for (std::size_t j = 0; j < columns; ++j) {
            const double cost = (left[i] - right[j]).squaredNorm();
            if (i == 0 && j == 0) {
                row[j] = cost;
                continue;
            }
            const double both = i > 0 && j > 0 ? row_before[j - 1] + 2.0 * cost : kNever;
            const double on_left = i > 0 ? row_before[j] + cost : kNever;
            const double on_right = j > 0 ? row[j - 1] + cost : kNever;
            row[j] = std::min({both, on_left, on_right});
            steps[i * columns + j] =
                row[j] == both ? Step::both : (row[j] == on_left ? Step::left : Step::right);
        }
    }

    std::vector<FacingPlaces> matching;
    std::size_t i = left.size() - 1;
    std::size_t j = columns - 1;
    matching.push_back({i, j});
    while (i > 0 || j > 0) {
        const Step step = steps[i * columns + j];
        if (step != Step::right) --i;
        if (step != Step::left) --j;
        matching.push_back({i, j});
    }
    std::ranges::reverse(matching);
    return matching;
}

}  // namespace conelane
