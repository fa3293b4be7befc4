#include "evaluation/scoring/text_table.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace conelane {

std::vector<std::string> TextTable::lines() const {
    std::vector<std::string> titles;
    for (const Column& column : columns_) titles.push_back(column.title);
    std::vector<std::size_t> widths(columns_.size());
    const auto widen = [&](const std::vector<std::string>& cells) {
        for (std::size_t i = 0; i < cells.size(); ++i) widths[i] = std::max(widths[i], cells[i].size());
    };
    widen(titles);
    std::ranges::for_each(rows_, widen);
    std::vector<std::string> lines;
    const auto append_line = [&](const std::vector<std::string>& cells) {
        std::string line;
        for (std::size_t i = 0; i < cells.size(); ++i) {
            if (i > 0) line.append(gap_, ' ');
            line += columns_[i].is_text ? fmt::format("{:<{}}", cells[i], widths[i])
                                        : fmt::format("{:>{}}", cells[i], widths[i]);
        }
        line.erase(line.find_last_not_of(' ') + 1);
        lines.push_back(line + '\n');
    };
    append_line(titles);
    std::ranges::for_each(rows_, append_line);
    return lines;
}

std::string TextTable::text() const {
    return fmt::format("{}", fmt::join(lines(), ""));
}

std::string fixed(std::optional<double> value, int decimals) {
    return value ? fmt::format("{:.{}f}", *value, decimals) : "-";
}

std::string percent(std::optional<double> share, int decimals) {
    return fixed(share ? std::optional(100.0 * *share) : std::nullopt, decimals);
}

}  // namespace conelane
