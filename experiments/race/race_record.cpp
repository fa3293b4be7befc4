#include "experiments/race/race_record.hpp"

#include "evaluation/scoring/statistics.hpp"
#include "evaluation/scoring/text_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace conelane::experiments {
namespace {

using Json = nlohmann::ordered_json;

/// A method with a share of false positives.
using Row = std::pair<std::string, double>;
/// The same on a course.
using Place = std::pair<std::string, Row>;

Row row_of(const Heat& heat) {
    return {heat.detector, heat.false_positive_rate};
}

/// The races of each key, in the order in which keys first occur.
template <typename Of>
auto grouped(std::span<const Heat> heats, const Of& of) {
    using Results = std::vector<const RaceResult*>;
    std::vector<std::pair<decltype(of(heats.front())), Results>> groups;
    for (const Heat& heat : heats) {
        const auto key = of(heat);
        auto group = std::ranges::find_if(groups, [&](const auto& other) { return other.first == key; });
        if (group == groups.end()) group = groups.insert(group, {key, {}});
        group->second.push_back(&heat.result);
    }
    return groups;
}

/// The numbers of the races that have one.
template <typename Number>
Sample known(std::span<const RaceResult* const> results, const Number& number) {
    Sample sample;
    for (const RaceResult* result : results) sample.add(number(*result));
    return sample;
}

template <typename Number>
double sum(std::span<const RaceResult* const> results, const Number& number) {
    double total = 0.0;
    for (const RaceResult* result : results) total += number(*result);
    return total;
}

/// The unfinished lap counts as one.
double hit_a_lap(const RaceResult& result) {
    return result.cones_hit / static_cast<double>(std::max(1, result.finished_laps + !result.finished()));
}

Json maybe(const std::optional<double>& value) {
    return value ? Json(*value) : Json();
}

double rounded(double value, double steps) {
    return std::round(value * steps) / steps;
}

Json flat(const std::vector<Point>& points) {
    Json list = Json::array();
    for (const Point& point : points) {
        for (const double m : {point.x(), point.y()}) list.push_back(rounded(m, 100.0));
    }
    return list;
}

/// A column of names, then columns of numbers.
TextTable table_by_method(std::initializer_list<const char*> numbers) {
    std::vector<TextTable::Column> columns{{"method", true}};
    for (const char* const title : numbers) columns.push_back({title});
    return TextTable(std::move(columns));
}

/// How far the unfinished races went; empty if there is none.
std::string lost_table(std::span<const Heat> heats) {
    TextTable table(
        {{"course", true}, {"method", true}, {"fp"}, {"not finished"}, {"m driven, median"}, {"how", true}});
    bool any = false;
    for (const auto& [place, races] :
         grouped(heats, [](const Heat& heat) { return Place(heat.course, row_of(heat)); })) {
        std::vector<double> driven_m;
        std::vector<std::string_view> how;
        for (const RaceResult* race : races) {
            if (race->finished()) continue;
            driven_m.push_back(race->driven_m);
            if (std::ranges::find(how, to_string(race->end)) == how.end())
                how.push_back(to_string(race->end));
        }
        if (driven_m.empty()) continue;
        any = true;
        table.add({place.first, place.second.first, fmt::format("{}", place.second.second),
                   fmt::format("{} of {}", driven_m.size(), races.size()), fixed(median(driven_m), 0),
                   fmt::format("{}", fmt::join(how, ", "))});
    }
    return any ? table.text() : "";
}

/// The race, without its result.
Json identity(const Heat& heat) {
    return {{"track", heat.course},
            {"method", heat.detector},
            {"false_positive_rate", heat.false_positive_rate},
            {"seed", heat.seed}};
}

}  // namespace

std::string race_table(std::span<const Heat> heats, int laps) {
    TextTable table =
        table_by_method({"fp", "races", "finished %", "laps %", "m to departure", "hit a lap", "error p95 m",
                         "no path %", "old path %", "unsteady %", "wrong path %"});
    for (const auto& [row, races] : grouped(heats, row_of)) {
        const auto total = [&](int RaceResult::*number) {
            return static_cast<std::size_t>(sum(races, [&](const RaceResult& r) { return r.*number; }));
        };
        const auto half = [&](std::optional<double> RaceResult::*number) {
            return known(races, [&](const RaceResult& r) { return r.*number; }).median();
        };
        const double time_s = sum(races, [](const RaceResult& r) { return r.time_s; });
        const double old_s = sum(races, [](const RaceResult& r) { return r.old_path_s; });
        const auto finished = sum(races, [](const RaceResult& r) { return r.finished() ? 1 : 0; });
        const auto count = static_cast<double>(races.size());
        const std::size_t frames = total(&RaceResult::frames);
        const std::size_t laps_wanted = races.size() * static_cast<std::size_t>(laps);
        table.add({row.first, fmt::format("{}", row.second), std::to_string(races.size()),
                   percent(share(static_cast<std::size_t>(finished), races.size()), 1),
                   percent(share(total(&RaceResult::finished_laps), laps_wanted), 1),
                   fixed(half(&RaceResult::departure_m), 0), fixed(sum(races, hit_a_lap) / count, 2),
                   fixed(half(&RaceResult::lateral_error_p95_m), 2),
                   percent(share(total(&RaceResult::frames_without_path), frames), 2),
                   time_s > 0.0 ? percent(old_s / time_s, 2) : "-",
                   percent(known(races, [](const RaceResult& r) { return r.unsteady_share; }).mean(), 1),
                   percent(share(total(&RaceResult::wrong_unflagged), frames), 2)});
    }
    const std::string lost = lost_table(heats);
    return table.text() + (lost.empty() ? "" : "\n" + lost);
}

std::string speed_table(std::span<const Heat> heats) {
    TextTable table = table_by_method({"fp", "laps", "time ratio", "safe < 3 m %", "right of these %",
                                       "trusted, wrong %", "sideways p95 m", "curvature 1/m"});
    for (const auto& [row, races] : grouped(heats, row_of)) {
        for (const std::size_t later : {0U, 1U}) {
            const auto of_lap = [later](const auto& of) {
                return [later, of](const RaceResult& r) { return std::invoke(of, r.by_lap[later]); };
            };
            const double frames = sum(races, of_lap(&LapFigures::frames));
            if (frames == 0.0) continue;
            const auto of_frames = [&](int LapFigures::*count) {
                return percent(sum(races, of_lap(count)) / frames, 2);
            };
            table.add({row.first, fmt::format("{}", row.second), later > 0 ? "later" : "first",
                       fixed(known(races, of_lap(&LapFigures::time_ratio)).mean(), 3),
                       of_frames(&LapFigures::short_frames), of_frames(&LapFigures::right_untrusted),
                       of_frames(&LapFigures::wrong_trusted),
                       fixed(known(races, of_lap(&LapFigures::sideways_p95_m)).mean(), 3),
                       fixed(known(races, of_lap(&LapFigures::max_curvature_1pm)).median(), 2)});
        }
    }
    return table.text();
}

std::string answer_time_table(std::span<const Heat> heats) {
    TextTable table = table_by_method({"answer median ms", "p99 ms"});
    for (const auto& [detector, races] : grouped(heats, [](const Heat& heat) { return heat.detector; })) {
        Sample times_ms;
        for (const RaceResult* race : races) {
            for (const double answer_ms : race->answer_ms) times_ms.add(answer_ms);
        }
        table.add({detector, fixed(times_ms.median(), 3), fixed(times_ms.quantile(0.99), 3)});
    }
    return table.text();
}

Json heat_json(const Heat& heat) {
    const RaceResult& r = heat.result;
    Json json = identity(heat);
    json.update({{"finished", r.finished()},
                 {"end", to_string(r.end)},
                 {"finished_laps", r.finished_laps},
                 {"driven_m", r.driven_m},
                 {"departure_m", maybe(r.departure_m)},
                 {"stop_said_m", maybe(r.stop_said_m)},
                 {"rest_m", maybe(r.rest_m)},
                 {"cones_hit", r.cones_hit},
                 {"lateral_error_p95_m", maybe(r.lateral_error_p95_m)},
                 {"frames", r.frames},
                 {"frames_without_path", r.frames_without_path},
                 {"frames_refused", r.frames_refused},
                 {"wrong_unflagged", r.wrong_unflagged},
                 {"time_s", r.time_s},
                 {"old_path_s", r.old_path_s},
                 {"unsteady_share", maybe(r.unsteady_share)},
                 {"laps_told", r.laps_told}});
    if (!r.phases.empty()) json["phases"] = r.phases;
    for (const std::size_t later : {0U, 1U}) {
        const LapFigures& lap = r.by_lap[later];
        if (!lap.known_lap_s) break;
        json[later > 0 ? "later_laps" : "first_lap"] = {{"laps", lap.laps},
                                                        {"time_s", lap.time_s},
                                                        {"known_course_lap_s", *lap.known_lap_s},
                                                        {"frames", lap.frames},
                                                        {"short_frames", lap.short_frames},
                                                        {"right_untrusted", lap.right_untrusted},
                                                        {"wrong_trusted", lap.wrong_trusted},
                                                        {"sideways_p95_m", maybe(lap.sideways_p95_m)},
                                                        {"max_curvature_1pm", lap.max_curvature_1pm}};
    }
    return json;
}

Json replay_json(const Heat& heat, const RaceCourse& course) {
    std::vector<Point> left;
    std::vector<Point> right;
    std::vector<Point> other;
    for (const Cone& cone : course.cones) {
        (cone.color == ConeColor::blue     ? left
         : cone.color == ConeColor::yellow ? right
                                           : other)
            .push_back(cone.position);
    }
    Json frames = Json::array();
    for (const ReplayFrame& frame : heat.result.replay) {
        frames.push_back({{"t", rounded(frame.time_s, 100.0)},
                          {"x", rounded(frame.pose.position.x(), 100.0)},
                          {"y", rounded(frame.pose.position.y(), 100.0)},
                          {"yaw", rounded(frame.pose.yaw_rad, 1000.0)},
                          {"state", frame.state},
                          {"path", flat(frame.path)},
                          {"seen", flat(frame.seen)}});
    }
    Json json = identity(heat);
    json.update({{"end", to_string(heat.result.end)},
                 {"left", flat(left)},
                 {"right", flat(right)},
                 {"other", flat(other)},
                 {"false_positives", flat(heat.result.false_positives)},
                 {"frames", std::move(frames)}});
    return json;
}

}  // namespace conelane::experiments
