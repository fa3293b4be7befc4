#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace conelane::path_pair {

/// Rows of bits in one block of memory that is kept between resets.
class BitMatrix {
  public:
    /// Clears all bits.
    void reset(int rows, int columns) {
        words_ = (static_cast<std::size_t>(columns) + 63) / 64;
        bits_.assign(static_cast<std::size_t>(rows) * words_, 0);
    }
    /// The same, word block by word block: returns false, with invalid bits, once `stop(words)` returns true.
    template <typename Stop>
    bool reset(int rows, int columns, const Stop& stop) {
        constexpr std::size_t kBlock = 16384;
        words_ = (static_cast<std::size_t>(columns) + 63) / 64;
        const std::size_t count = static_cast<std::size_t>(rows) * words_;
        bits_.clear();
        bits_.reserve(count);
        while (bits_.size() < count) {
            const std::size_t before = bits_.size();
            bits_.resize(std::min(count, before + kBlock), 0);
            if (stop(bits_.size() - before)) return false;
        }
        return true;
    }
    void set(int row, int column) { word(row, column) |= mask(column); }
    [[nodiscard]] bool test(int row, int column) const {
        return (bits_[static_cast<std::size_t>(row) * words_ + static_cast<std::size_t>(column) / 64] &
                mask(column)) != 0;
    }
    [[nodiscard]] std::span<const std::uint64_t> row(int row) const {
        return {bits_.data() + static_cast<std::size_t>(row) * words_, words_};
    }

  private:
    [[nodiscard]] std::uint64_t& word(int row, int column) {
        return bits_[static_cast<std::size_t>(row) * words_ + static_cast<std::size_t>(column) / 64];
    }
    static std::uint64_t mask(int column) { return std::uint64_t{1} << (static_cast<unsigned>(column) % 64); }

    std::size_t words_ = 0;
    std::vector<std::uint64_t> bits_;
};

}  // namespace conelane::path_pair
