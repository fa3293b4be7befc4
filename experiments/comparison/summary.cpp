#include "experiments/comparison/summary.hpp"

#include "evaluation/scoring/lane_failure.hpp"
#include "evaluation/scoring/statistics.hpp"

#include <algorithm>
#include <array>
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
constexpr std::size_t kMaxLabelWidth = 24;  ///< a longer name is cut
constexpr std::size_t kCellWidth = 6;       ///< " 100.0"
constexpr std::size_t kLatencyWidth = 9;
constexpr std::string_view kGroupGap = "  ";

/// Counts over some scenes of a method.
struct Tally {
    std::size_t known = 0;  ///< scenes for which it is known whether the lane is usable
    std::size_t usable = 0;
    std::size_t scenes = 0;
    std::array<std::size_t, kLaneFailureCount> failures{};
    std::vector<double> latencies_ms;

    void add(const ScoredRecord& record) {
        ++scenes;
        latencies_ms.push_back(record.score.latency_ms);
        const std::optional<bool> is_usable = record.score.usable();
        if (!is_usable) return;
        ++known;
        if (*is_usable) ++usable;
        if (record.failure) ++failures[static_cast<std::size_t>(*record.failure)];
    }
    [[nodiscard]] double percent(std::size_t count) const {
        return 100.0 * static_cast<double>(count) / static_cast<double>(known);
    }
};

struct Row {
    std::string label;
    bool is_trained = false;
    Tally all;
    std::map<std::size_t, Tally> of_column;
};

/// What a group of columns has in common.
struct GroupKey {
    std::string condition;
    std::optional<double> rate;  ///< for groups of cone-set sizes
    bool operator==(const GroupKey&) const = default;
};

struct Column {
    GroupKey group;
    std::optional<double> value;  ///< a rate, or a cone-set size
    bool operator==(const Column&) const = default;
};

using Places = std::vector<std::size_t>;

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
    explicit Summary(std::span<const ScoredRecord> scored) {
        std::map<std::string, std::set<std::optional<std::size_t>>> sizes;
        for (const ScoredRecord& record : scored)
            sizes[record.record->detector].insert(record.record->nearest);
        by_size_ =
            std::ranges::any_of(sizes, [](const auto& of_method) { return of_method.second.size() > 1; });
        for (const ScoredRecord& record : scored) add(record);
        sort();
    }

    [[nodiscard]] std::string text(const std::vector<std::string>& notes) const {
        const std::vector<Places> blocks = fitting_blocks();
        const std::size_t blocks_count = blocks.size() * (by_size_ ? 2 : 1);
        const std::size_t tables = blocks_count + 1;  // and the line of failures
        bool any_trained = false;
        for (const Row& row : rows_) any_trained = any_trained || row.is_trained;
        const std::size_t fixed =
            1 + 3 * blocks_count + 2 + notes.size() + (any_trained ? 1 : 0) + 1 + kLinesBelowSummary;
        const std::size_t room = fixed < kSummaryLines ? (kSummaryLines - fixed) / tables : 0;
        const std::size_t rows = std::min(rows_.size(), std::max(room, kMinRows));

        std::string text = cut(headline(), kSummaryColumns) + '\n';
        for (std::size_t i = 0; i < blocks.size(); ++i)
            text += usable_block(blocks[i], rows, i == 0 && !by_size_);
        if (by_size_) {
            for (const Places& block : blocks) text += latency_block(block, rows);
        }
        text += "Not usable, in % of the scenes, and why\n";
        for (std::size_t i = 0; i < rows; ++i) text += failures_line(rows_[i]);
        text += '\n';
        if (any_trained) text += "* with courses that the method has learned from: no held-out figure\n";
        text += left_out_line(blocks, rows);
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
        if (row == rows_.end()) row = rows_.insert(rows_.end(), Row{label, false, {}, {}});
        Column column{{scene.condition, {}}, scene.false_positive_rate};
        ranges_m_.insert(scene.range_m);
        if (by_size_) {
            column.group.rate = scene.false_positive_rate;
            column.value.reset();
            if (nearest) column.value = static_cast<double>(*nearest);
        }
        std::size_t place = std::ranges::find(columns_, column) - columns_.begin();
        if (place == columns_.size()) columns_.push_back(column);
        row->is_trained = row->is_trained || record.score.trained_on;
        row->all.add(record);
        row->of_column[place].add(record);
    }

    /// Best first; methods without known scenes last.
    void sort() {
        std::ranges::stable_sort(rows_, [](const Row& a, const Row& b) {
            if (a.all.known == 0 || b.all.known == 0) return a.all.known > b.all.known;
            return a.all.percent(a.all.usable) > b.all.percent(b.all.usable);
        });
        // Groups in the order in which they first appear, their columns ascending.
        std::vector<GroupKey> groups;
        for (const Column& column : columns_) {
            if (std::ranges::find(groups, column.group) == groups.end()) groups.push_back(column.group);
        }
        order_.resize(columns_.size());
        std::iota(order_.begin(), order_.end(), 0U);
        std::ranges::stable_sort(order_, {}, [&](std::size_t place) {
            const Column& column = columns_[place];
            return std::pair(std::ranges::find(groups, column.group) - groups.begin(), column.value);
        });
    }

    [[nodiscard]] std::size_t label_width() const {
        std::size_t width = std::string_view("method").size();
        for (const Row& row : rows_) width = std::max(width, row.label.size() + (row.is_trained ? 1 : 0));
        return std::min(width, kMaxLabelWidth);
    }

    /// Places columns side by side while there is room, then in a block below; columns that are left over
    /// have no place.
    [[nodiscard]] std::vector<Places> fitting_blocks() const {
        std::vector<Places> blocks(1);
        std::size_t used = 0;
        const auto room_of = [&](std::size_t block) {
            const bool has_latency = block == 0 && !by_size_;
            return kSummaryColumns - label_width() - (has_latency ? 2 * kLatencyWidth : 0);
        };
        for (std::size_t i = 0; i < order_.size(); ++i) {
            const bool begins_group =
                blocks.back().empty() || !(columns_[order_[i]].group == columns_[order_[i - 1]].group);
            // A group that fits into one block is not split.
            std::size_t needed = kCellWidth;
            if (begins_group) {
                std::size_t members = 0;
                for (const std::size_t place : order_) {
                    if (columns_[place].group == columns_[order_[i]].group) ++members;
                }
                const std::size_t whole = kGroupGap.size() + members * kCellWidth;
                needed =
                    whole <= room_of(1) && !blocks.back().empty() ? whole : kGroupGap.size() + kCellWidth;
            }
            if (used + needed > room_of(blocks.size() - 1)) {
                if (blocks.size() == (by_size_ ? 1 : kMaxBlocks)) break;
                blocks.emplace_back();
                used = 0;
            }
            used += kCellWidth + (begins_group || blocks.back().empty() ? kGroupGap.size() : 0);
            blocks.back().push_back(order_[i]);
        }
        return blocks;
    }

    [[nodiscard]] std::string group_title(const GroupKey& group, std::size_t width) const {
        std::string title = group.condition;
        const auto append = [&](const std::string& part) { title += (title.empty() ? "" : ", ") + part; };
        if (group.rate && by_size_) append(percent_title(*group.rate) + " %");
        return cut(title, width);
    }

    [[nodiscard]] std::string headline() const {
        std::string ranges;
        for (const std::optional<double>& range_m : ranges_m_) {
            if (range_m) ranges += fmt::format("{}{:g}", ranges.empty() ? "; range " : ", ", *range_m);
        }
        if (!ranges.empty()) ranges += ranges_m_.size() > 1 ? " m together" : " m";
        return fmt::format("Usable lanes in %, by {}; {} scenes a method{}",
                           by_size_ ? "cone-set size" : "share of false positives in %",
                           rows_.front().all.scenes, ranges);
    }

    [[nodiscard]] std::string column_title(const Column& column) const {
        if (by_size_) return column.value ? fmt::format("n={:g}", *column.value) : "all";
        return column.value ? percent_title(*column.value) : "-";
    }

    /// The two lines above a block.
    [[nodiscard]] std::string header(const Places& block, const std::string& what, bool with_latency) const {
        std::string groups = fmt::format("{:<{}}", what, label_width());
        std::string titles = fmt::format("{:<{}}", "method", label_width());
        for (std::size_t begin = 0; begin < block.size();) {
            const GroupKey& group = columns_[block[begin]].group;
            std::size_t end = begin;
            titles += kGroupGap;
            for (; end < block.size() && columns_[block[end]].group == group; ++end)
                titles += fmt::format("{:>{}}", cut(column_title(columns_[block[end]]), kCellWidth - 1),
                                      kCellWidth);
            const std::size_t width = (end - begin) * kCellWidth;
            groups += fmt::format("{}{:>{}}", kGroupGap, group_title(group, width), width);
            begin = end;
        }
        if (with_latency) {
            groups += fmt::format("{:>{}}", "latency in ms", 2 * kLatencyWidth);
            titles += fmt::format("{:>{}}{:>{}}", "median", kLatencyWidth, "p99", kLatencyWidth);
        }
        return groups + '\n' + titles + '\n';
    }

    template <typename Text>
    [[nodiscard]] std::string cells(const Row& row, const Places& block, Text text) const {
        std::string line = fmt::format("{:<{}}", label_of(row), label_width());
        for (std::size_t i = 0; i < block.size(); ++i) {
            if (i == 0 || !(columns_[block[i]].group == columns_[block[i - 1]].group)) line += kGroupGap;
            const auto tally = row.of_column.find(block[i]);
            line +=
                fmt::format("{:>{}}", tally == row.of_column.end() ? "-" : text(tally->second), kCellWidth);
        }
        return line;
    }

    [[nodiscard]] std::string usable_block(const Places& block, std::size_t rows, bool with_latency) const {
        std::string text = header(block, by_size_ ? "usable %" : "", with_latency);
        for (std::size_t i = 0; i < rows; ++i) {
            text += cells(rows_[i], block, [](const Tally& tally) {
                return tally.known == 0 ? "-" : fmt::format("{:.1f}", tally.percent(tally.usable));
            });
            if (with_latency) {
                const std::vector<double>& all_ms = rows_[i].all.latencies_ms;
                text += fmt::format("{:>{}.2f}{:>{}.2f}", median(all_ms), kLatencyWidth,
                                    quantile(all_ms, 0.99), kLatencyWidth);
            }
            text += '\n';
        }
        return text + '\n';
    }

    [[nodiscard]] std::string latency_block(const Places& block, std::size_t rows) const {
        std::string text = header(block, "median ms", false);
        for (std::size_t i = 0; i < rows; ++i) {
            text += cells(rows_[i], block, [](const Tally& tally) {
                const double median_ms = median(tally.latencies_ms);
                return fmt::format("{:.{}f}", median_ms, median_ms < 100.0 ? 2 : 0);
            });
            text += '\n';
        }
        return text + '\n';
    }

    [[nodiscard]] std::string label_of(const Row& row) const {
        return row.is_trained ? cut(row.label, kMaxLabelWidth - 1) + '*' : cut(row.label, kMaxLabelWidth);
    }

    /// The causes by their shares; equal shares in the order of the causes; as many as there is room for.
    [[nodiscard]] std::string failures_line(const Row& row) const {
        std::string line = fmt::format("{:<{}}{}", label_of(row), label_width(), kGroupGap);
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

    [[nodiscard]] std::string left_out_line(const std::vector<Places>& blocks, std::size_t rows) const {
        std::size_t shown = 0;
        for (const Places& block : blocks) shown += block.size();
        std::string text;
        const auto append = [&](std::size_t count, const char* what) {
            if (count == 0) return;
            text += fmt::format("{}{} {}{}", text.empty() ? "" : " and ", count, what, count == 1 ? "" : "s");
        };
        append(rows_.size() - rows, "more method");
        append(columns_.size() - shown, "more column");
        return text.empty() ? "" : text + ": see the wide table\n";
    }

    bool by_size_ = false;  ///< columns are cone-set sizes instead of rates
    std::set<std::optional<double>> ranges_m_;
    std::vector<Row> rows_;
    std::vector<Column> columns_;  ///< in the order in which they are first met
    Places order_;                 ///< order in which the columns are shown
};

}  // namespace

std::string summary(std::span<const ScoredRecord> scored, const std::vector<std::string>& notes) {
    if (scored.empty()) return "";
    return Summary(scored).text(notes);
}

std::vector<std::string> summary_notes(const OutsideDetectors& outside, const LeftOutScenes& left_out) {
    std::vector<std::string> notes;
    std::string names;
    for (const OutsideDetector& method : outside.detectors)
        names += (names.empty() ? "" : ", ") + method.name;
    if (!names.empty()) notes.push_back("from outside, with notes below the wide table: " + names);
    if (const std::string note = note_on(left_out); !note.empty()) notes.push_back(note);
    return notes;
}

}  // namespace conelane::experiments
