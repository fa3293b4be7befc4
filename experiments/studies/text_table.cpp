#include "experiments/studies/text_table.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace conelane::experiments {

std::string TextTable::text() const {
    std::vector<std::size_t> widths;
    for (const Column& column : columns_) widths.push_back(column.title.size());
    for (const auto& row : rows_) {
        for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
    }
    std::string text;
    const auto append_line = [&](const auto& cell) {
        std::string line;
        for (std::size_t i = 0; i < columns_.size(); ++i) {
            if (i > 0) line += ' ';
            line += columns_[i].is_text ? fmt::format("{:<{}}", cell(i), widths[i])
                                        : fmt::format("{:>{}}", cell(i), widths[i]);
        }
        line.erase(line.find_last_not_of(' ') + 1);
        text += line + '\n';
    };
    append_line([&](std::size_t i) { return columns_[i].title; });
    for (const auto& row : rows_) append_line([&](std::size_t i) { return row[i]; });
    return text;
}

std::string fixed(std::optional<double> value, int decimals) {
    return value ? fmt::format("{:.{}f}", *value, decimals) : "-";
}

std::string percent(std::optional<double> share, int decimals) {
    return fixed(share ? std::optional(100.0 * *share) : std::nullopt, decimals);
}

std::optional<double> share(std::size_t part, std::size_t whole) {
    if (whole == 0) return std::nullopt;
    return static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace conelane::experiments
