#include "evaluation/scoring/score_table.hpp"

#include "evaluation/scoring/published_figures.hpp"
#include "evaluation/scoring/text_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <string_view>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace conelane {
namespace {

/// A measure of a row: its key in JSON and, where the table shows it, its title and format.
struct Measure {
    std::string_view key;
    std::string_view title;
    int digits;
    double factor;
    std::optional<double> (*of)(const ScoreSummary& summary);
};
template <auto member>
std::optional<double> of(const ScoreSummary& summary) {
    return summary.*member;
}
template <auto member>
std::optional<double> of_latency(const ScoreSummary& summary) {
    return summary.latency.*member;
}
using S = ScoreSummary;
constexpr std::array kLaneMeasures{
    Measure{"usable_share", "usable %", 1, 100.0, of<&S::usable_share>},
    Measure{"success_share", "success %", 1, 100.0, of<&S::success_share>},
    Measure{"mean_iou", "IoU %", 1, 100.0, of<&S::mean_iou>},
    Measure{"lateral_median_m", "centre m", 2, 1.0, of<&S::lateral_median_m>},
    Measure{"lateral_p95_m", "p95 m", 2, 1.0, of<&S::lateral_p95_m>},
    Measure{"heading_median_rad", "", 3, 1.0, of<&S::heading_median_rad>},
    Measure{"heading_p95_rad", "heading p95 rad", 3, 1.0, of<&S::heading_p95_rad>},
    Measure{"unsteady_share", "unsteady %", 1, 100.0, of<&S::unsteady_share>}};
constexpr std::array kSearchMeasures{
    Measure{"accurate_share", "accurate %", 1, 100.0, of<&S::accurate_share>},
    Measure{"solved_share", "solved %", 1, 100.0, of<&S::solved_share>},
    Measure{"complete_share", "complete %", 1, 100.0, of<&S::complete_share>},
    Measure{"best_candidate_mean_iou", "", 1, 100.0, of<&S::best_candidate_mean_iou>},
    Measure{"best_candidate_near_share", "", 1, 100.0, of<&S::best_candidate_near_share>}};
using L = LatencyStatistics;
constexpr std::array kLatencies{
    Measure{"median", "median ms", 2, 1.0, of_latency<&L::median_ms>},
    Measure{"mean", "mean ms", 2, 1.0, of_latency<&L::mean_ms>},
    Measure{"standard_deviation", "", 2, 1.0, of_latency<&L::standard_deviation_ms>},
    Measure{"p95", "p95 ms", 2, 1.0, of_latency<&L::p95_ms>},
    Measure{"p99", "p99 ms", 2, 1.0, of_latency<&L::p99_ms>},
    Measure{"max", "max ms", 2, 1.0, of_latency<&L::max_ms>},
    Measure{"shifted_geometric_mean", "", 2, 1.0, of_latency<&L::shifted_geometric_mean_ms>}};

constexpr std::array<std::string_view, 27> kTitles{
    "method",   "condition",  "fp %",     "range m",   "scenes",          "usable %",   "success %",
    "IoU %",    "accurate %", "GT %",     "near GT %", "too short %",     "div>=20 %",  "div<20 %",
    "none %",   "error %",    "centre m", "p95 m",     "heading p95 rad", "unsteady %", "complete %",
    "solved %", "median ms",  "mean ms",  "p95 ms",    "p99 ms",          "max ms"};
/// Cells by their titles; unknown ones are missing.
using Line = std::map<std::string_view, std::string>;

void put(Line& line, std::string_view title, std::optional<double> value, int digits) {
    if (value) line[title] = fmt::format("{:.{}f}", *value, digits);
}

void put_percent(Line& line, std::string_view title, std::optional<double> share) {
    if (share) put(line, title, 100.0 * *share, 1);
}

Line line_of(const ScoreRow& row) {
    const ScoreSummary& summary = row.summary;
    Line line;
    for (const std::span<const Measure> measures :
         {std::span<const Measure>(kLaneMeasures), {kSearchMeasures}, {kLatencies}}) {
        for (const Measure& measure : measures) {
            if (const std::optional<double> value = measure.of(summary))
                put(line, measure.title, measure.factor * *value, measure.digits);
        }
    }
    line["method"] = row.key.detector_label();
    if (!row.key.condition.empty()) line["condition"] = row.key.condition;
    put_percent(line, "fp %", row.key.false_positive_rate);
    put(line, "range m", row.key.range_m, 0);
    line["scenes"] = fmt::format("{}{}", summary.scenes, summary.trained_on > 0 ? "*" : "");
    put_percent(line, "GT %", summary.share(Category::ground_truth));
    // An error counts as no lane in every other measure; here each scene is in exactly one column.
    const double error_share = static_cast<double>(summary.errors) / static_cast<double>(summary.scenes);
    put_percent(line, "none %", std::max(0.0, summary.share(Category::none) - error_share));
    put_percent(line, "error %", error_share);
    // If divergence is unknown in all scenes, all shares that depend on it are unknown, not zero.
    if (summary.divergence_unknown < summary.scenes) {
        put_percent(line, "near GT %", summary.share(Category::near_ground_truth));
        put_percent(line, "too short %", summary.share(Category::too_short));
        put_percent(line, "div>=20 %", summary.share(Category::diverging_from_20));
        put_percent(line, "div<20 %", summary.share(Category::diverging_below_20));
    } else {
        line.erase("success %");
    }
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
        Line& line = lines.emplace_back();
        line["method"] = "CLC paper";
        put_percent(line, "fp %", row.false_positive_rate);
        line["range m"] = "30+50";
        for (const auto& [title, value] : {std::pair{"GT %", row.ground_truth},
                                           {"near GT %", row.near_ground_truth},
                                           {"too short %", row.too_short},
                                           {"div>=20 %", row.diverging_from_20},
                                           {"div<20 %", row.diverging_below_20},
                                           {"success %", row.success},
                                           {"IoU %", row.mean_iou},
                                           {"complete %", row.complete}})
            put(line, title, value, 1);
        line["median ms"] = fmt::format("<{:.0f}", kPublishedClcMedianBelow_ms);
        put(line, "max ms", kPublishedClcMax_ms, 0);
    }
    for (const PublishedRldRow& row : kPublishedRld) {
        Line& line = lines.emplace_back();
        line["method"] = fmt::format("RLD paper {}", row.printed_ratio);
        put_percent(line, "fp %", row.false_positive_rate);
        put(line, "accurate %", 100.0 - row.inaccurate, row.upper_bound ? 0 : 2);
        if (row.upper_bound) line["accurate %"].insert(0, ">");
    }
    Line& timing = lines.emplace_back();
    timing["method"] = fmt::format("RLD paper n={}", kPublishedRldConeSet);
    put(timing, "solved %", kPublishedRldSolved, 2);
    put(timing, "mean ms", kPublishedRldMean_ms, 2);
    put(timing, "p95 ms", kPublishedRldP95_ms, 2);
    return lines;
}

template <typename Value>
void put_if_known(nlohmann::ordered_json& json, const char* key, const std::optional<Value>& value) {
    if (value) json[key] = *value;
}

/// Bins as [lanes, mean confidence, share usable], without empty bins.
nlohmann::ordered_json to_json(const Calibration& calibration) {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    put_if_known(json, "error", calibration.error());
    put_if_known(json, "sure_share", calibration.sure());
    put_if_known(json, "usable_where_sure_share", calibration.usable_where_sure());
    put_if_known(json, "right_where_trusted_share", calibration.right_where_trusted());
    put_if_known(json, "trusted_share", calibration.trusted_share());
    for (const Calibration::Bin& bin : calibration.bins()) {
        if (bin.lanes == 0) continue;
        const auto lanes = static_cast<double>(bin.lanes);
        json["bins"].push_back({bin.lanes, bin.confidence / lanes, static_cast<double>(bin.usable) / lanes});
    }
    return json;
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
    std::vector<Line> lines;
    std::ranges::transform(rows, std::back_inserter(lines), line_of);
    std::ranges::move(published_lines(rows), std::back_inserter(lines));
    std::vector<TextTable::Column> columns;
    for (const std::string_view title : kTitles) {
        if (title != "condition" ||
            std::ranges::any_of(lines, [&](const Line& line) { return line.contains(title); }))
            columns.push_back({std::string(title), columns.empty()});
    }
    TextTable table(columns, 2);
    for (Line& line : lines) {
        std::vector<std::string> cells;
        for (const TextTable::Column& column : columns)
            cells.push_back(line.emplace(column.title, "-").first->second);
        table.add(std::move(cells));
    }
    const std::vector<std::string> texts = table.lines();
    std::string notes;
    std::size_t unknown = 0;
    for (const ScoreRow& row : rows) unknown += row.summary.divergence_unknown;
    if (unknown > 0) {
        notes += fmt::format("divergence unknown, scenes scored without the boundaries of their track: {}\n",
                             unknown);
    }
    if (std::ranges::any_of(rows, [](const ScoreRow& row) { return row.summary.trained_on > 0; }))
        notes += "* with courses that the method has learned from: no held-out figure\n";
    notes += "published (other machines; CLC: Tables I, II and VIII-G; RLD: IV, Figs. 6 and 7)\n";
    const auto own = static_cast<std::ptrdiff_t>(rows.size()) + 1;
    return fmt::format("{}{}{}", fmt::join(texts.begin(), texts.begin() + own, ""), notes,
                       fmt::join(texts.begin() + own, texts.end(), ""));
}

std::string ScoreKey::detector_label() const {
    return nearest ? fmt::format("{} n={}", detector, *nearest) : detector;
}

nlohmann::ordered_json summary_json(const ScoreRow& row) {
    const ScoreSummary& summary = row.summary;
    nlohmann::ordered_json json;
    const auto put_measures = [&](nlohmann::ordered_json& object, std::span<const Measure> measures) {
        for (const Measure& measure : measures) {
            if (const auto value = measure.of(summary)) object[std::string(measure.key)] = *value;
        }
    };
    json["method"] = row.key.detector;
    put_if_known(json, "nearest", row.key.nearest);
    if (!row.key.condition.empty()) json["condition"] = row.key.condition;
    put_if_known(json, "false_positive_rate", row.key.false_positive_rate);
    put_if_known(json, "range", row.key.range_m);
    json["scenes"] = summary.scenes;
    json["errors"] = summary.errors;
    json["divergence_unknown"] = summary.divergence_unknown;
    if (summary.trained_on > 0) json["trained_on"] = summary.trained_on;
    for (std::size_t i = 0; i < kCategoryCount; ++i) {
        json["share"][std::string(to_string(static_cast<Category>(i)))] = summary.category_share[i];
    }
    put_measures(json, kLaneMeasures);
    if (auto said = to_json(summary.calibration); !said.empty()) json["calibration"] = std::move(said);
    json["accuracy_scenes"] = summary.accuracy_scenes;
    put_measures(json, kSearchMeasures);
    put_measures(json["latency_ms"], kLatencies);
    json["within_budget_share"] = summary.latency.share_within_budget;
    return json;
}

}  // namespace conelane
