#include "experiments/comparison/summary.hpp"

#include "evaluation/scoring/lane_failure.hpp"
#include "evaluation/scoring/statistics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

constexpr std::size_t kMaxBlocks = 2;       ///< one below the other
constexpr std::size_t kMinRows = 3;         ///< rows that are shown even if other lines have no room
constexpr std::size_t kMinRowsOfSizes = 2;  ///< the same, of cone sets, which have more tables
constexpr std::size_t kMaxLabelWidth = 24;  ///< a longer name is cut
constexpr std::size_t kCellWidth = 6;       ///< " 100.0"
constexpr std::size_t kLatencyWidth = 9;
constexpr std::string_view kGroupGap = "  ";
constexpr double kAllCones = std::numeric_limits<double>::infinity();  ///< as a cone-set size

/// Counts over some scenes of a method.
struct Tally {
    std::size_t known = 0;  ///< scenes for which it is known whether the lane is usable
    std::size_t usable = 0;
    std::size_t scenes = 0;
    std::array<std::size_t, kLaneFailureCount> failures{};
    std::size_t judged = 0;  ///< scenes for which accuracy is known
    std::size_t accurate = 0;
    std::size_t asked = 0;  ///< scenes in which a proof was looked for
    std::size_t solved = 0;
    std::vector<double> latencies_ms;

    void add(const ScoredRecord& record) {
        ++scenes;
        latencies_ms.push_back(record.score.latency_ms);
        judged += record.score.accuracy ? 1 : 0;
        accurate += record.score.accurate() ? 1 : 0;
        asked += record.score.solved_to_optimality ? 1 : 0;
        solved += record.score.solved_to_optimality.value_or(false) ? 1 : 0;
        const std::optional<bool> is_usable = record.score.usable();
        if (!is_usable) return;
        ++known;
        if (*is_usable) ++usable;
        if (record.failure) ++failures[static_cast<std::size_t>(*record.failure)];
    }
    [[nodiscard]] double percent(std::size_t count) const {
        return 100.0 * static_cast<double>(count) / static_cast<double>(known);
    }
    [[nodiscard]] std::string median_text() const { return milliseconds(median(latencies_ms)); }
    [[nodiscard]] std::string p95_text() const { return milliseconds(quantile(latencies_ms, 0.95)); }
    [[nodiscard]] std::string usable_text() const { return share_text(usable, known); }
    [[nodiscard]] std::string accurate_text() const { return share_text(accurate, judged); }
    [[nodiscard]] std::string solved_text() const { return share_text(solved, asked); }

  private:
    static std::string milliseconds(double time_ms) {
        return fmt::format("{:.{}f}", time_ms, time_ms < 100.0 ? 2 : 0);
    }
    static std::string share_text(std::size_t part, std::size_t of) {
        return of == 0 ? "-"
                       : fmt::format("{:.1f}", 100.0 * static_cast<double>(part) / static_cast<double>(of));
    }
};

/// A table of the summary: a measure of each column.
struct Measure {
    std::string_view title;
    std::string (Tally::*text)() const;
    enum class More { nothing, latency, growth } more = More::nothing;  ///< to the right of the columns
};
constexpr std::array kOfRates{Measure{"", &Tally::usable_text, Measure::More::latency}};
/// Few cones end before a lane is usable, so of sizes there is accuracy among these cones.
constexpr std::array kOfSizes{
    Measure{"accurate %", &Tally::accurate_text}, Measure{"proven %", &Tally::solved_text},
    Measure{"median ms", &Tally::median_text, Measure::More::growth}, Measure{"p95 ms", &Tally::p95_text}};

/// A rate or a cone-set size, in a group of what its columns have in common: the groups in the order in which
/// they first appear, their columns ascending.
struct Column {
    std::size_t group;
    std::optional<double> value;
    auto operator<=>(const Column&) const = default;
};
using Block = std::vector<Column>;

struct Row {
    std::string label;
    bool is_trained = false;
    Tally all = {};
    std::map<Column, Tally> of_column = {};
};

std::string cut(std::string text, std::size_t width) {
    if (text.size() <= width) return text;
    text.resize(width - 1);
    // Does not cut a character of several bytes.
    while (!text.empty() && (static_cast<unsigned char>(text.back()) & 0xC0U) == 0x80U) text.pop_back();
    if (!text.empty() && (static_cast<unsigned char>(text.back()) & 0x80U) != 0U) text.pop_back();
    return text + "~";
}

/// Formats such as 30 and 16.7.
std::string percent_title(double share) {
    std::string text = fmt::format("{:.1f}", 100.0 * share);
    if (text.ends_with(".0")) text.resize(text.size() - 2);
    return text;
}

class Summary {
  public:
    explicit Summary(std::span<const ScoredMethod> methods) {
        std::set<std::string> names;
        for (const ScoredMethod& method : methods)
            by_size_ = !names.insert(method.method.name).second || by_size_;
        for (const ScoredMethod& method : methods) {
            for (const ScoredRecord& record : method.scores) add(record);
        }
        // Best first; methods without known scenes last; of sizes in the order of the methods.
        std::ranges::stable_sort(rows_, [&](const Row& a, const Row& b) {
            if (by_size_) return false;
            if (a.all.known == 0 || b.all.known == 0) return a.all.known > b.all.known;
            return a.all.percent(a.all.usable) > b.all.percent(b.all.usable);
        });
        for (const Row& row : rows_)
            label_width_ = std::max(label_width_, row.label.size() + (row.is_trained ? 1 : 0));
        if (by_size_) label_width_ = std::max(label_width_, kOfSizes.front().title.size());
        label_width_ = std::min(label_width_, kMaxLabelWidth);
    }

    [[nodiscard]] std::string text(const std::vector<std::string>& notes) const {
        if (rows_.empty()) return "";
        const std::vector<Block> blocks = fitting_blocks();
        const std::span<const Measure> measures = by_size_ ? std::span<const Measure>(kOfSizes) : kOfRates;
        const std::size_t blocks_count = blocks.size() * measures.size();
        const std::size_t tables = blocks_count + (by_size_ ? 0 : 1);  // and the line of failures
        const bool any_trained = std::ranges::any_of(rows_, &Row::is_trained);
        const std::size_t fixed = 1 + (has_groups() ? 3 : 2) * blocks_count + 2 + notes.size() +
                                  (any_trained ? 1 : 0) + 1 + kLinesBelowSummary;
        const std::size_t room = fixed < kSummaryLines ? (kSummaryLines - fixed) / tables : 0;
        const auto shown = std::span(rows_).first(
            std::min(rows_.size(), std::max(room, by_size_ ? kMinRowsOfSizes : kMinRows)));

        std::string text = cut(headline(), kSummaryColumns) + '\n';
        for (Measure measure : measures) {
            for (const Block& block : blocks) {
                text += table(block, shown, measure);
                measure.more = Measure::More::nothing;
            }
        }
        if (!by_size_) {
            text += "Not usable, in % of the scenes, and why\n";
            for (const Row& row : shown) text += failures_line(row);
            text += '\n';
        }
        if (any_trained) text += "* with courses that the method has learned from: no held-out figure\n";
        text += left_out_line(blocks, shown.size());
        for (const std::string& note : notes) text += cut(note, kSummaryColumns) + '\n';
        return text;
    }

  private:
    void add(const ScoredRecord& record) {
        const AnnotatedScene& scene = *record.scene;
        const std::optional<std::size_t> nearest = record.record->nearest;
        std::string label = record.record->detector;
        if (!by_size_ && nearest) label += fmt::format(" n={}", *nearest);
        auto row = std::ranges::find(rows_, label, &Row::label);
        if (row == rows_.end()) row = rows_.insert(rows_.end(), Row{label});
        Group group{scene.condition, {}};
        Column column{0, scene.false_positive_rate};
        if (by_size_) {
            group.second = scene.false_positive_rate;
            column.value = nearest ? static_cast<double>(*nearest) : kAllCones;
        }
        column.group = static_cast<std::size_t>(std::ranges::find(groups_, group) - groups_.begin());
        if (column.group == groups_.size()) groups_.push_back(group);
        columns_.insert(column);
        ranges_m_.insert(scene.range_m);
        row->is_trained = row->is_trained || record.score.trained_on;
        row->all.add(record);
        row->of_column[column].add(record);
    }

    /// Places columns side by side while there is room, then in a block below; columns that are left over
    /// have no place.
    [[nodiscard]] std::vector<Block> fitting_blocks() const {
        std::vector<Block> blocks(1);
        std::size_t used = 0;
        const auto room_of = [&](std::size_t block) {
            const std::size_t more = by_size_ ? kLatencyWidth : block == 0 ? 2 * kLatencyWidth : 0;
            return kSummaryColumns - label_width_ - more;
        };
        for (const Column& column : columns_) {
            // A group that fits into one block is not split.
            const std::size_t whole =
                kGroupGap.size() + kCellWidth * static_cast<std::size_t>(std::ranges::count(
                                                    columns_, column.group, &Column::group));
            const bool is_first = blocks.back().empty();
            const bool begins_group = is_first || blocks.back().back().group != column.group;
            std::size_t needed = kCellWidth + (begins_group ? kGroupGap.size() : 0);
            if (begins_group && !is_first && whole <= room_of(1)) needed = whole;
            if (used + needed > room_of(blocks.size() - 1)) {
                if (blocks.size() == (by_size_ ? 1 : kMaxBlocks)) break;
                blocks.emplace_back();
                used = 0;
            }
            used += kCellWidth + (begins_group || blocks.back().empty() ? kGroupGap.size() : 0);
            blocks.back().push_back(column);
        }
        return blocks;
    }

    [[nodiscard]] std::string headline() const {
        std::string ranges;
        for (const std::optional<double>& range_m : ranges_m_) {
            if (range_m) ranges += fmt::format("{}{:g}", ranges.empty() ? "; range " : ", ", *range_m);
        }
        if (!ranges.empty()) ranges += ranges_m_.size() > 1 ? " m together" : " m";
        const std::string what = by_size_ ? "Each method among the n nearest cones" + one_group()
                                          : "Usable lanes in %, by share of false positives in %";
        return fmt::format("{}; {} scenes a method{}", what, rows_.front().all.scenes, ranges);
    }

    /// Whether the columns are of several conditions and rates; else the headline names the one that there
    /// is.
    [[nodiscard]] bool has_groups() const { return !by_size_ || groups_.size() > 1; }
    [[nodiscard]] std::string one_group() const {
        const std::string title = group_title(0);
        return has_groups() || title.empty() ? "" : ", " + title + (groups_[0].second ? " false" : "");
    }

    [[nodiscard]] std::string column_title(const Column& column) const {
        if (by_size_) return *column.value < kAllCones ? fmt::format("n={:g}", *column.value) : "all";
        return column.value ? percent_title(*column.value) : "-";
    }

    [[nodiscard]] std::string group_title(std::size_t group) const {
        const auto& [condition, rate] = groups_[group];
        if (!rate) return condition;
        return condition + (condition.empty() ? "" : ", ") + percent_title(*rate) + " %";
    }

    template <typename Text>
    [[nodiscard]] std::string line(std::string_view label, const Block& block, const Text& text) const {
        std::string line = fmt::format("{:<{}}", label, label_width_);
        for (std::size_t i = 0; i < block.size(); ++i) {
            if (i == 0 || block[i].group != block[i - 1].group) line += kGroupGap;
            line += fmt::format("{:>{}}", text(block[i]), kCellWidth);
        }
        return line;
    }

    /// The line of the groups, if there are several, that of the columns, and a line for each method.
    [[nodiscard]] std::string table(const Block& block, std::span<const Row> rows,
                                    const Measure& measure) const {
        using More = Measure::More;
        std::string text;
        if (has_groups()) {
            text = fmt::format("{:<{}}", measure.title, label_width_);
            for (std::size_t begin = 0, end = 0; begin < block.size(); begin = end) {
                while (end < block.size() && block[end].group == block[begin].group) ++end;
                const std::size_t width = (end - begin) * kCellWidth;
                text +=
                    fmt::format("{}{:>{}}", kGroupGap, cut(group_title(block[begin].group), width), width);
            }
            if (measure.more == More::latency)
                text += fmt::format("{:>{}}", "latency in ms", 2 * kLatencyWidth);
            text += '\n';
        }
        text += line(has_groups() ? "method" : measure.title, block,
                     [&](const Column& column) { return cut(column_title(column), kCellWidth - 1); });
        if (measure.more == More::latency)
            text += fmt::format("{:>{}}{:>{}}", "median", kLatencyWidth, "p99", kLatencyWidth);
        if (measure.more == More::growth) text += fmt::format("{:>{}}", "growth", kLatencyWidth);
        for (const Row& row : rows) {
            text += '\n' + line(label_of(row), block, [&](const Column& column) {
                        const auto tally = row.of_column.find(column);
                        return tally == row.of_column.end() ? "-" : (tally->second.*measure.text)();
                    });
            const std::vector<double>& all_ms = row.all.latencies_ms;
            if (measure.more == More::latency)
                text += fmt::format("{:>{}.2f}{:>{}.2f}", median(all_ms), kLatencyWidth,
                                    quantile(all_ms, 0.99), kLatencyWidth);
            if (measure.more == More::growth) text += fmt::format("{:>{}}", growth_text(row), kLatencyWidth);
        }
        return text + "\n\n";
    }

    /// The power of n by which the median grows from the least to the largest size of the first group.
    static std::string growth_text(const Row& row) {
        const std::pair<const Column, Tally>*least = nullptr, *most = nullptr;
        for (const auto& of_size : row.of_column) {
            const auto& [group, size] = of_size.first;
            if (group > 0 || *size == kAllCones || *size == 0.0) continue;
            if (least == nullptr) least = &of_size;
            most = &of_size;
        }
        if (least == most) return "-";
        return fmt::format("n^{:.1f}",
                           std::log(median(most->second.latencies_ms) / median(least->second.latencies_ms)) /
                               std::log(*most->first.value / *least->first.value));
    }

    [[nodiscard]] static std::string label_of(const Row& row) {
        return row.is_trained ? cut(row.label, kMaxLabelWidth - 1) + '*' : cut(row.label, kMaxLabelWidth);
    }

    /// The causes by their shares; equal shares in the order of the causes; as many as there is room for.
    [[nodiscard]] std::string failures_line(const Row& row) const {
        std::string line = fmt::format("{:<{}}{}", label_of(row), label_width_, kGroupGap);
        if (row.all.known == 0) return line + "    -\n";
        line += fmt::format("{:>5.1f}", row.all.percent(row.all.known - row.all.usable));
        std::vector<std::size_t> causes(kLaneFailureCount);
        std::iota(causes.begin(), causes.end(), 0U);
        std::ranges::stable_sort(causes, std::greater{}, [&](std::size_t i) { return row.all.failures[i]; });
        std::string_view between = "  ";
        std::size_t rest = row.all.known - row.all.usable;  // not named so far
        for (const std::size_t i : causes) {
            const std::size_t count = row.all.failures[i];
            if (count == 0) break;
            std::string cause(to_string(static_cast<LaneFailure>(i)));
            std::ranges::replace(cause, '_', ' ');
            const std::string piece = fmt::format("{}{} {:.1f}", between, cause, row.all.percent(count));
            constexpr std::size_t kRoomForTheRest = 12;  // room for ", other 12.3"
            if (line.size() + piece.size() + (rest > count ? kRoomForTheRest : 0) > kSummaryColumns) break;
            line += piece;
            rest -= count;
            between = ", ";
        }
        if (rest > 0) line += fmt::format("{}other {:.1f}", between, row.all.percent(rest));
        return line + '\n';
    }

    [[nodiscard]] std::string left_out_line(std::span<const Block> blocks, std::size_t rows) const {
        std::size_t shown = 0;
        for (const Block& block : blocks) shown += block.size();
        std::string text;
        const auto append = [&](std::size_t count, const char* what) {
            if (count == 0) return;
            text += fmt::format("{}{} {}{}", text.empty() ? "" : " and ", count, what, count == 1 ? "" : "s");
        };
        append(rows_.size() - rows, "more method");
        append(columns_.size() - shown, "more column");
        return text.empty() ? "" : text + ": see the wide table\n";
    }

    using Group = std::pair<std::string, std::optional<double>>;  ///< condition; with sizes also the rate
    bool by_size_ = false;  ///< columns are cone-set sizes instead of rates
    std::set<std::optional<double>> ranges_m_;
    std::vector<Row> rows_;
    std::vector<Group> groups_;
    std::set<Column> columns_;
    std::size_t label_width_ = std::string_view("method").size();
};

}  // namespace

std::string summary(std::span<const ScoredMethod> methods, const LeftOutScenes& left_out) {
    std::string names;
    for (const ScoredMethod& scored : methods) {
        const MethodRecord& method = scored.method;
        const bool is_first = &scored == &methods.front() || (&scored - 1)->method.name != method.name;
        if (!method.outside().empty() && is_first) names += (names.empty() ? "" : ", ") + method.name;
    }
    std::vector<std::string> notes;
    if (!names.empty()) notes.push_back("from outside, with notes below the wide table: " + names);
    if (const std::string note = note_on(left_out); !note.empty()) notes.push_back(note);
    return summary(methods, notes);
}

std::string summary(std::span<const ScoredMethod> methods, const std::vector<std::string>& notes) {
    return Summary(methods).text(notes);
}

}  // namespace conelane::experiments
