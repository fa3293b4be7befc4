#include "evaluation/scoring/score_table.hpp"

#include "evaluation/scoring/published_figures.hpp"
#include "evaluation/scoring/text_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <string_view>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace conelane {
namespace {

struct Column {
    enum Index : std::size_t {
        detector,
        condition,
        rate,
        range,
        scenes,
        usable,
        success,
        iou,
        accurate,
        ground_truth,
        near_ground_truth,
        too_short,
        diverging_from_20,
        diverging_below_20,
        none,
        error,
        lateral_median,
        lateral_p95,
        heading_p95,
        unsteady,
        complete,
        solved,
        median,
        mean,
        p95,
        p99,
        max,
        count
    };
};
constexpr std::array<std::string_view, Column::count> kHeader{
    "method",   "condition",  "fp %",     "range m",   "scenes",          "usable %",   "success %",
    "IoU %",    "accurate %", "GT %",     "near GT %", "too short %",     "div>=20 %",  "div<20 %",
    "none %",   "error %",    "centre m", "p95 m",     "heading p95 rad", "unsteady %", "complete %",
    "solved %", "median ms",  "mean ms",  "p95 ms",    "p99 ms",          "max ms"};
using Line = std::array<std::string, Column::count>;
constexpr std::string_view kUnknown = "-";

Line empty_line() {
    Line line;
    line.fill(std::string(kUnknown));
    return line;
}

Line line_of(const ScoreRow& row) {
    const ScoreSummary& summary = row.summary;
    Line line = empty_line();
    line[Column::detector] = row.key.detector_label();
    if (!row.key.condition.empty()) line[Column::condition] = row.key.condition;
    line[Column::rate] = percent(row.key.false_positive_rate, 1);
    line[Column::range] = fixed(row.key.range_m, 0);
    line[Column::scenes] = fmt::format("{}{}", summary.scenes, summary.trained_on > 0 ? "*" : "");
    line[Column::ground_truth] = percent(summary.share(Category::ground_truth), 1);
    // An error counts as no lane in every other measure; here each scene is in exactly one column.
    const double error_share = static_cast<double>(summary.errors) / static_cast<double>(summary.scenes);
    line[Column::none] = percent(std::max(0.0, summary.share(Category::none) - error_share), 1);
    line[Column::error] = percent(error_share, 1);
    // If divergence is unknown in all scenes, all shares that depend on it are unknown, not zero.
    if (summary.divergence_unknown < summary.scenes) {
        line[Column::near_ground_truth] = percent(summary.share(Category::near_ground_truth), 1);
        line[Column::too_short] = percent(summary.share(Category::too_short), 1);
        line[Column::diverging_from_20] = percent(summary.share(Category::diverging_from_20), 1);
        line[Column::diverging_below_20] = percent(summary.share(Category::diverging_below_20), 1);
        line[Column::success] = percent(summary.success_share, 1);
    }
    line[Column::usable] = percent(summary.usable_share, 1);
    line[Column::lateral_median] = fixed(summary.lateral_median_m, 2);
    line[Column::lateral_p95] = fixed(summary.lateral_p95_m, 2);
    line[Column::heading_p95] = fixed(summary.heading_p95_rad, 3);
    line[Column::unsteady] = percent(summary.unsteady_share, 1);
    line[Column::iou] = percent(summary.mean_iou, 1);
    line[Column::accurate] = percent(summary.accurate_share, 1);
    line[Column::complete] = percent(summary.complete_share, 1);
    line[Column::solved] = percent(summary.solved_share, 1);
    line[Column::median] = fixed(summary.latency.median_ms, 2);
    line[Column::mean] = fixed(summary.latency.mean_ms, 2);
    line[Column::p95] = fixed(summary.latency.p95_ms, 2);
    line[Column::p99] = fixed(summary.latency.p99_ms, 2);
    line[Column::max] = fixed(summary.latency.max_ms, 2);
    return line;
}

bool has_rate(std::span<const ScoreRow> rows, double rate) {
    constexpr double kSameRate = 1e-6;
    return std::ranges::any_of(rows, [&](const ScoreRow& row) {
        return row.key.false_positive_rate && std::abs(*row.key.false_positive_rate - rate) < kSameRate;
    });
}

std::vector<Line> published_lines(std::span<const ScoreRow> rows) {
    std::vector<Line> lines;
    const bool any_rate = std::ranges::any_of(
        kPublishedClc, [&](const PublishedClcRow& row) { return has_rate(rows, row.false_positive_rate); });
    for (const PublishedClcRow& row : kPublishedClc) {
        if (any_rate && !has_rate(rows, row.false_positive_rate)) continue;
        Line line = empty_line();
        line[Column::detector] = "CLC paper";
        line[Column::rate] = percent(row.false_positive_rate, 1);
        line[Column::range] = "30+50";
        line[Column::ground_truth] = fixed(row.ground_truth, 1);
        line[Column::near_ground_truth] = fixed(row.near_ground_truth, 1);
        line[Column::too_short] = fixed(row.too_short, 1);
        line[Column::diverging_from_20] = fixed(row.diverging_from_20, 1);
        line[Column::diverging_below_20] = fixed(row.diverging_below_20, 1);
        line[Column::success] = fixed(row.success, 1);
        line[Column::iou] = fixed(row.mean_iou, 1);
        line[Column::complete] = fixed(row.complete, 1);
        line[Column::median] = "<" + fixed(kPublishedClcMedianBelow_ms, 0);
        line[Column::max] = fixed(kPublishedClcMax_ms, 0);
        lines.push_back(line);
    }
    for (const PublishedRldRow& row : kPublishedRld) {
        Line line = empty_line();
        line[Column::detector] = fmt::format("RLD paper {}", row.printed_ratio);
        line[Column::rate] = percent(row.false_positive_rate, 1);
        line[Column::accurate] =
            (row.upper_bound ? ">" : "") + fixed(100.0 - row.inaccurate, row.upper_bound ? 0 : 2);
        lines.push_back(line);
    }
    Line timing = empty_line();
    timing[Column::detector] = fmt::format("RLD paper n={}", kPublishedRldConeSet);
    timing[Column::solved] = fixed(kPublishedRldSolved, 2);
    timing[Column::mean] = fixed(kPublishedRldMean_ms, 2);
    timing[Column::p95] = fixed(kPublishedRldP95_ms, 2);
    lines.push_back(timing);
    return lines;
}

}  // namespace

std::vector<ScoreRow> summarise_by_key(std::span<const KeyedScore> scores) {
    std::map<std::string, std::size_t> detector_rank;
    std::map<std::string, std::size_t> condition_rank;
    using Order = std::tuple<std::size_t, std::size_t, std::optional<double>, std::optional<double>>;
    std::map<Order, std::vector<SceneScore>> groups;
    std::map<Order, ScoreKey> keys;
    for (const KeyedScore& keyed : scores) {
        const std::size_t rank =
            detector_rank.emplace(keyed.key.detector_label(), detector_rank.size()).first->second;
        const std::size_t condition =
            condition_rank.emplace(keyed.key.condition, condition_rank.size()).first->second;
        const Order order{rank, condition, keyed.key.false_positive_rate, keyed.key.range_m};
        groups[order].push_back(keyed.score);
        keys.emplace(order, keyed.key);
    }
    std::vector<ScoreRow> rows;
    for (const auto& [order, group] : groups) rows.push_back({keys.at(order), summarise(group)});
    return rows;
}

std::string score_table(std::span<const ScoreRow> rows) {
    const bool is_condition_named =
        std::ranges::any_of(rows, [](const ScoreRow& row) { return !row.key.condition.empty(); });
    const auto is_shown = [&](std::size_t column) {
        return column != Column::condition || is_condition_named;
    };
    std::vector<TextTable::Column> columns;
    for (std::size_t i = 0; i < kHeader.size(); ++i) {
        if (is_shown(i)) columns.push_back({std::string(kHeader[i]), i == Column::detector});
    }
    TextTable text(std::move(columns), 2);
    const auto add = [&](const Line& line) {
        std::vector<std::string> cells;
        for (std::size_t i = 0; i < line.size(); ++i) {
            if (is_shown(i)) cells.push_back(line[i]);
        }
        text.add(std::move(cells));
    };
    for (const ScoreRow& row : rows) add(line_of(row));
    std::ranges::for_each(published_lines(rows), add);
    const std::vector<std::string> lines = text.lines();
    const auto published = lines.begin() + 1 + static_cast<std::ptrdiff_t>(rows.size());
    std::string table = fmt::format("{}", fmt::join(lines.begin(), published, ""));
    std::size_t unknown = 0;
    for (const ScoreRow& row : rows) unknown += row.summary.divergence_unknown;
    if (unknown > 0) {
        table += fmt::format("divergence unknown, scenes scored without the boundaries of their track: {}\n",
                             unknown);
    }
    if (std::ranges::any_of(rows, [](const ScoreRow& row) { return row.summary.trained_on > 0; }))
        table += "* with courses that the method has learned from: no held-out figure\n";
    table += "published (other machines; CLC: Tables I, II and VIII-G; RLD: IV, Figs. 6 and 7)\n";
    return table + fmt::format("{}", fmt::join(published, lines.end(), ""));
}

std::string ScoreKey::detector_label() const {
    return nearest ? fmt::format("{} n={}", detector, *nearest) : detector;
}

namespace {

/// Bins as [lanes, mean confidence, share usable], without empty bins.
nlohmann::ordered_json to_json(const Calibration& calibration) {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    const auto put_if_known = [&](const char* key, const auto& value) {
        if (value) json[key] = *value;
    };
    put_if_known("error", calibration.error());
    put_if_known("sure_share", calibration.sure());
    put_if_known("usable_where_sure_share", calibration.usable_where_sure());
    put_if_known("right_where_trusted_share", calibration.right_where_trusted());
    put_if_known("trusted_share", calibration.trusted_share());
    for (const Calibration::Bin& bin : calibration.bins()) {
        if (bin.lanes == 0) continue;
        const auto lanes = static_cast<double>(bin.lanes);
        json["bins"].push_back({bin.lanes, bin.confidence / lanes, static_cast<double>(bin.usable) / lanes});
    }
    return json;
}

}  // namespace

std::string summary_json(const ScoreRow& row) {
    const ScoreSummary& summary = row.summary;
    nlohmann::ordered_json json;
    const auto put_if_known = [&](const char* key, const auto& value) {
        if (value) json[key] = *value;
    };
    json["method"] = row.key.detector;
    put_if_known("nearest", row.key.nearest);
    if (!row.key.condition.empty()) json["condition"] = row.key.condition;
    put_if_known("false_positive_rate", row.key.false_positive_rate);
    put_if_known("range", row.key.range_m);
    json["scenes"] = summary.scenes;
    json["errors"] = summary.errors;
    json["divergence_unknown"] = summary.divergence_unknown;
    if (summary.trained_on > 0) json["trained_on"] = summary.trained_on;
    for (std::size_t i = 0; i < kCategoryCount; ++i) {
        json["share"][std::string(to_string(static_cast<Category>(i)))] = summary.category_share[i];
    }
    put_if_known("usable_share", summary.usable_share);
    json["success_share"] = summary.success_share;
    put_if_known("mean_iou", summary.mean_iou);
    put_if_known("lateral_median_m", summary.lateral_median_m);
    put_if_known("lateral_p95_m", summary.lateral_p95_m);
    put_if_known("heading_median_rad", summary.heading_median_rad);
    put_if_known("heading_p95_rad", summary.heading_p95_rad);
    put_if_known("unsteady_share", summary.unsteady_share);
    if (const auto said = to_json(summary.calibration); !said.empty()) json["calibration"] = said;
    json["accuracy_scenes"] = summary.accuracy_scenes;
    put_if_known("accurate_share", summary.accurate_share);
    put_if_known("solved_share", summary.solved_share);
    put_if_known("complete_share", summary.complete_share);
    put_if_known("best_candidate_mean_iou", summary.best_candidate_mean_iou);
    put_if_known("best_candidate_near_share", summary.best_candidate_near_share);
    const LatencyStatistics& latency = summary.latency;
    json["latency_ms"] = {{"median", latency.median_ms},
                          {"mean", latency.mean_ms},
                          {"standard_deviation", latency.standard_deviation_ms},
                          {"p95", latency.p95_ms},
                          {"p99", latency.p99_ms},
                          {"max", latency.max_ms},
                          {"shifted_geometric_mean", latency.shifted_geometric_mean_ms}};
    json["within_budget_share"] = latency.share_within_budget;
    // A detector name from a file may contain bytes that are not UTF-8.
    return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace conelane
