#include "experiments/race/race_record.hpp"

#include "evaluation/scoring/statistics.hpp"
#include "evaluation/scoring/text_table.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace conelane::experiments {
namespace {

using Json = nlohmann::ordered_json;

/// The different keys, in the order in which they first occur.
template <typename Key, typename Of>
std::vector<Key> distinct(std::span<const Heat> heats, const Of& of) {
    std::vector<Key> keys;
    for (const Heat& heat : heats) {
        const Key key = of(heat);
        if (std::ranges::find(keys, key) == keys.end()) keys.push_back(key);
    }
    return keys;
}

struct Sums {
    std::size_t races = 0;
    std::size_t finished = 0;
    std::size_t laps = 0;
    std::size_t frames = 0;
    std::size_t without = 0;
    std::size_t wrong = 0;
    double hit = 0.0;
    double time_s = 0.0;
    double old_s = 0.0;
    Sample departures_m;
    Sample errors_m;
    Sample unsteady;

    void add(const RaceResult& result) {
        ++races;
        finished += result.finished() ? 1 : 0;
        laps += static_cast<std::size_t>(result.finished_laps);
        frames += static_cast<std::size_t>(result.frames);
        without += static_cast<std::size_t>(result.frames_without_path);
        wrong += static_cast<std::size_t>(result.wrong_unflagged);
        // The unfinished lap counts as one.
        hit += result.cones_hit / static_cast<double>(std::max(1, result.finished_laps + !result.finished()));
        time_s += result.time_s;
        old_s += result.old_path_s;
        departures_m.add(result.departure_m);
        errors_m.add(result.lateral_error_p95_m);
        unsteady.add(result.unsteady_share);
    }
};

Json maybe(const std::optional<double>& value) {
    return value ? Json(*value) : Json();
}

Json flat(const std::vector<Point>& points) {
    Json list = Json::array();
    for (const Point& point : points) {
        list.push_back(std::round(point.x() * 100.0) / 100.0);
        list.push_back(std::round(point.y() * 100.0) / 100.0);
    }
    return list;
}

}  // namespace

std::string race_table(std::span<const Heat> heats, int laps) {
    TextTable table({{"method", true},
                     {"fp"},
                     {"races"},
                     {"finished %"},
                     {"laps %"},
                     {"m to departure"},
                     {"hit a lap"},
                     {"error p95 m"},
                     {"no path %"},
                     {"old path %"},
                     {"unsteady %"},
                     {"wrong path %"}});
    using Row = std::pair<std::string, double>;
    for (const Row& row : distinct<Row>(
             heats, [](const Heat& heat) { return Row(heat.detector, heat.false_positive_rate); })) {
        Sums sums;
        for (const Heat& heat : heats) {
            if (Row(heat.detector, heat.false_positive_rate) == row) sums.add(heat.result);
        }
        const auto count = static_cast<double>(sums.races);
        table.add({row.first, fmt::format("{}", row.second), std::to_string(sums.races),
                   percent(share(sums.finished, sums.races), 1),
                   percent(share(sums.laps, sums.races * static_cast<std::size_t>(laps)), 1),
                   fixed(sums.departures_m.median(), 0), fixed(sums.hit / count, 2),
                   fixed(sums.errors_m.median(), 2), percent(share(sums.without, sums.frames), 2),
                   sums.time_s > 0.0 ? percent(sums.old_s / sums.time_s, 2) : "-",
                   percent(sums.unsteady.mean(), 1), percent(share(sums.wrong, sums.frames), 2)});
    }
    std::string text = table.text();
    TextTable lost(
        {{"course", true}, {"method", true}, {"fp"}, {"not finished"}, {"m driven, median"}, {"how", true}});
    bool any = false;
    using Place = std::pair<std::string, Row>;
    for (const Place& place : distinct<Place>(heats, [](const Heat& heat) {
             return Place(heat.course, Row(heat.detector, heat.false_positive_rate));
         })) {
        std::size_t races = 0;
        Sample driven_m;
        std::vector<std::string> how;
        for (const Heat& heat : heats) {
            if (Place(heat.course, Row(heat.detector, heat.false_positive_rate)) != place) continue;
            ++races;
            if (heat.result.finished()) continue;
            driven_m.add(heat.result.driven_m);
            const std::string word(to_string(heat.result.end));
            if (std::ranges::find(how, word) == how.end()) how.push_back(word);
        }
        if (driven_m.values().empty()) continue;
        any = true;
        std::string words;
        for (const std::string& word : how) words += (words.empty() ? "" : ", ") + word;
        lost.add({place.first, place.second.first, fmt::format("{}", place.second.second),
                  fmt::format("{} of {}", driven_m.values().size(), races), fixed(driven_m.median(), 0),
                  words});
    }
    if (any) text += "\n" + lost.text();
    return text;
}

std::string answer_time_table(std::span<const Heat> heats) {
    TextTable table({{"method", true}, {"answer median ms"}, {"p99 ms"}});
    for (const std::string& detector :
         distinct<std::string>(heats, [](const Heat& heat) { return heat.detector; })) {
        Sample times_ms;
        for (const Heat& heat : heats) {
            if (heat.detector != detector) continue;
            for (const double answer_ms : heat.result.answer_ms) times_ms.add(answer_ms);
        }
        table.add({detector, fixed(times_ms.median(), 3), fixed(times_ms.quantile(0.99), 3)});
    }
    return table.text();
}

Json heat_json(const Heat& heat) {
    const RaceResult& r = heat.result;
    Json json{{"track", heat.course},
              {"method", heat.detector},
              {"false_positive_rate", heat.false_positive_rate},
              {"seed", heat.seed},
              {"finished", r.finished()},
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
              {"laps_told", r.laps_told}};
    if (!r.phases.empty()) json["phases"] = r.phases;
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
        frames.push_back({{"t", std::round(frame.time_s * 100.0) / 100.0},
                          {"x", std::round(frame.pose.position.x() * 100.0) / 100.0},
                          {"y", std::round(frame.pose.position.y() * 100.0) / 100.0},
                          {"yaw", std::round(frame.pose.yaw_rad * 1000.0) / 1000.0},
                          {"state", frame.state},
                          {"path", flat(frame.path)},
                          {"seen", flat(frame.seen)}});
    }
    return {{"track", heat.course},
            {"method", heat.detector},
            {"false_positive_rate", heat.false_positive_rate},
            {"seed", heat.seed},
            {"end", to_string(heat.result.end)},
            {"left", flat(left)},
            {"right", flat(right)},
            {"other", flat(other)},
            {"false_positives", flat(heat.result.false_positives)},
            {"frames", std::move(frames)}};
}

}  // namespace conelane::experiments
