#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace conelane {

/// A table for a terminal: a line of titles, then a line for each row; a column is as wide as its widest
/// cell.
class TextTable {
  public:
    struct Column {
        std::string title;
        bool is_text = false;  ///< aligned to the left; numbers are aligned to the right
    };
    /// `gap`: number of blanks between two columns.
    explicit TextTable(std::vector<Column> columns, std::size_t gap = 1)
        : columns_(std::move(columns)), gap_(gap) {}

    /// Precondition: as many cells as columns.
    void add(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }

    /// The titles, then the rows; each line ends with a line feed.
    [[nodiscard]] std::vector<std::string> lines() const;
    [[nodiscard]] std::string text() const;

  private:
    std::vector<Column> columns_;
    std::size_t gap_;
    std::vector<std::vector<std::string>> rows_;
};

/// With this many decimals; "-" if absent.
[[nodiscard]] std::string fixed(std::optional<double> value, int decimals);

/// A share times 100, as `fixed`.
[[nodiscard]] std::string percent(std::optional<double> share, int decimals);

}  // namespace conelane
