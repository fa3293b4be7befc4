#pragma once

#include "solvers/path_pair/search_clock.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace conelane::path_pair {

// Vectors of up to millions of values, written or copied piece by piece, with checks of the clock between: a
// vector that grows by itself copies all of them in one go, which takes milliseconds.

namespace timed_growth {
inline constexpr std::size_t kValuesAtOnce = 16384;
inline constexpr std::size_t kWorkPerValue = 3;  ///< in steps of the clock
}  // namespace timed_growth

/// Replaces the content by `count` copies of the value. False, with fewer copies, if the time ends before.
template <typename T>
[[nodiscard]] bool fill(std::vector<T>& values, std::size_t count, T value, SearchClock& clock) {
    values.clear();
    values.reserve(count);
    while (values.size() < count) {
        const std::size_t more = std::min(count - values.size(), timed_growth::kValuesAtOnce);
        if (clock.tick(timed_growth::kWorkPerValue * more)) return false;
        values.resize(values.size() + more, value);
    }
    return true;
}

/// Makes room for `count` more values; the capacity doubles when it grows. Returns false, with the vector
/// unchanged, if the time ends before.
template <typename T>
[[nodiscard]] bool make_room(std::vector<T>& values, std::size_t more, SearchClock& clock) {
    if (values.size() + more <= values.capacity()) return true;
    std::vector<T> grown;
    grown.reserve(std::max(values.size() + more, 2 * values.capacity()));
    while (grown.size() < values.size()) {
        const std::size_t count = std::min(values.size() - grown.size(), timed_growth::kValuesAtOnce);
        if (clock.tick(timed_growth::kWorkPerValue * count)) return false;
        const auto begin = values.begin() + static_cast<std::ptrdiff_t>(grown.size());
        grown.insert(grown.end(), begin, begin + static_cast<std::ptrdiff_t>(count));
    }
    values = std::move(grown);
    return true;
}

}  // namespace conelane::path_pair
