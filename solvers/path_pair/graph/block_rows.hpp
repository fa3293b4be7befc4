#pragma once

#include "solvers/path_pair/search_clock.hpp"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

namespace conelane::path_pair {

/// Rows of equal width that are added one by one and never move. A growing vector of millions would copy them
/// all, which takes longer than the allowed overrun.
template <typename T>
class BlockRows {
  public:
    /// No rows; memory is kept.
    void reset(std::size_t width) {
        width_ = width = std::max<std::size_t>(width, 1);
        size_ = 0;
        // Uses the same blocks for any width: a power of two of rows in each, or one row if rows are wide.
        shift_ = 0;
        while ((std::size_t{2} << shift_) * width <= kEntriesPerBlock) ++shift_;
        const std::size_t entries = std::max(width, kEntriesPerBlock);
        if (entries > block_entries_) blocks_.clear();
        if (blocks_.empty()) block_entries_ = entries;
    }
    /// Returns the new row, with the old content of its memory.
    T* add() {
        if (size_ >> shift_ == blocks_.size()) {
            blocks_.push_back(std::make_unique_for_overwrite<T[]>(block_entries_));
        }
        return row(size_++);
    }
    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] T* row(std::size_t number) { return at(number); }
    [[nodiscard]] const T* row(std::size_t number) const { return at(number); }

  private:
    static constexpr std::size_t kEntriesPerBlock = 1 << 14;

    [[nodiscard]] T* at(std::size_t number) const {
        return blocks_[number >> shift_].get() + (number & ((std::size_t{1} << shift_) - 1)) * width_;
    }

    std::size_t width_ = 1;
    std::size_t size_ = 0;
    unsigned shift_ = 0;             ///< rows of a block, as a power of two
    std::size_t block_entries_ = 0;  ///< of the blocks that are there
    std::vector<std::unique_ptr<T[]>> blocks_;
};

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
