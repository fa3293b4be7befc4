#include "evaluation/formats/run_log.hpp"

#include "evaluation/formats/json_node.hpp"
#include "evaluation/formats/track_readers.hpp"
#include "evaluation/input_error.hpp"
#include "evaluation/world/run_boundaries.hpp"
#include "evaluation/world/track_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/core.h>

namespace conelane {
namespace {

constexpr double kSameCone_m = 0.8;  ///< in two frames
constexpr double kRunOver_m = 0.5;   ///< from the middle of the car

/// The colors of the five lists of a map.
constexpr std::array kListColors{ConeColor::unknown, ConeColor::yellow, ConeColor::blue, ConeColor::orange,
                                 ConeColor::orange};

Point read_point(const JsonNode& json) {
    if (json.array_size() != 2) json.fail("must be [x, y]");
    const auto coordinate = [&](std::size_t axis) {
        const double value = json.element(axis).number();
        if (const std::string fault = coordinate_fault(value); !fault.empty()) json.element(axis).fail(fault);
        return value;
    };
    return {coordinate(0), coordinate(1)};
}

std::vector<Cone> read_map(const JsonNode& json) {
    if (json.array_size() != kListColors.size()) json.fail("must hold five lists");
    std::vector<Cone> cones;
    for (std::size_t list = 0; list < kListColors.size(); ++list) {
        const JsonNode points = json.element(list);
        const std::size_t size = points.array_size();
        for (std::size_t i = 0; i < size; ++i) {
            cones.push_back({0, read_point(points.element(i)), kListColors[list], 1.0});
        }
    }
    return cones;
}

Pose read_pose(const JsonNode& frame) {
    const Point direction = read_point(frame.member("car_direction"));
    if (!(direction.norm() > 0.0)) frame.member("car_direction").fail("must not be [0, 0]");
    return {read_point(frame.member("car_position")), std::atan2(direction.y(), direction.x())};
}

/// Adds a map to the known cones. Each of its cones is a known one within kSameCone_m (nearest pairs first),
/// or a new one.
std::vector<MapPlace> recognise(const std::vector<Cone>& map, std::vector<Cone>& known) {
    std::vector<std::tuple<double, std::size_t, std::size_t>>
        pairs;  // distance, place in the map, known cone
    for (std::size_t i = 0; i < map.size(); ++i) {
        for (std::size_t j = 0; j < known.size(); ++j) {
            const double distance_m = (map[i].position - known[j].position).norm();
            if (distance_m <= kSameCone_m) pairs.emplace_back(distance_m, i, j);
        }
    }
    std::ranges::sort(pairs);
    constexpr auto kNone = static_cast<std::size_t>(-1);
    std::vector<std::size_t> known_of(map.size(), kNone);
    std::vector<bool> taken(known.size(), false);
    for (const auto& [distance_m, i, j] : pairs) {
        if (known_of[i] != kNone || taken[j]) continue;
        known_of[i] = j;
        taken[j] = true;
    }
    std::vector<MapPlace> places;
    for (std::size_t i = 0; i < map.size(); ++i) {
        if (known_of[i] == kNone) {
            known_of[i] = known.size();
            known.push_back(map[i]);
            known.back().id = static_cast<ConeId>(known_of[i]);
        }
        known[known_of[i]].position = map[i].position;
        known[known_of[i]].color = map[i].color;
        places.push_back({known_of[i], map[i].position});
    }
    return places;
}

/// Whether the car hits a cone of the map between two places.
bool runs_over_a_cone(const Track& run, const RunFrame& map, const Segment& way) {
    return std::ranges::any_of(map.map, [&](const MapPlace& place) {
        return foot_point(run.cones[place.cone].position, way).distance_m <= kRunOver_m;
    });
}

/// Sets the driven path and drops the frames after its end.
void set_driven_path(Track& run) {
    const RunFrame last_map = run.frames.back();
    std::size_t kept = 1;
    while (kept < run.frames.size() &&
           !runs_over_a_cone(run, last_map,
                             {run.frames[kept - 1].pose.position, run.frames[kept].pose.position})) {
        ++kept;
    }
    if (kept < run.frames.size()) {
        run.warnings.push_back(
            fmt::format("the car runs over a cone after {:.1f} m; {} frames from there on are left out",
                        run.frames[kept].travelled_m, run.frames.size() - kept));
    }
    run.frames.resize(kept);
    for (const RunFrame& frame : run.frames) run.driven.push_back(frame.pose.position);
}

}  // namespace

Track read_run_log(const std::filesystem::path& file) {
    Track run;
    run.name = "ftlog_" + file.stem().string();
    run.closed = false;
    with_json_list_file(file, [&](const JsonNode& list) {
        const std::size_t size = list.array_size();
        if (size == 0) list.fail("holds no frame");
        for (std::size_t i = 0; i < size; ++i) {
            const JsonNode frame = list.element(i);
            RunFrame read{read_pose(frame), 0.0, recognise(read_map(frame.member("slam_cones")), run.cones)};
            if (i > 0) {
                const RunFrame& before = run.frames.back();
                read.travelled_m = before.travelled_m + (read.pose.position - before.pose.position).norm();
            }
            run.frames.push_back(std::move(read));
        }
    });
    if (run.cones.empty()) throw InputError(file, 0, "slam_cones", "no frame has a cone");

    const auto colored = [&](ConeColor color) {
        return std::ranges::count(run.cones, color, &Cone::color) >= 2;
    };
    std::vector<Point> path;
    for (const RunFrame& frame : run.frames) path.push_back(frame.pose.position);
    if (colored(ConeColor::blue) && colored(ConeColor::yellow)) {
        if (set_boundaries_along(path, run)) return without_doubled_cones(std::move(run));
        run.warnings.emplace_back(
            "its coloured cones bound no lane along the driven path; the path alone counts");
    }
    set_driven_path(run);
    return run;
}

Frame read_run_frame(const JsonNode& json) {
    Frame frame{0.0, read_pose(json), read_map(json.member("slam_cones"))};
    for (Cone& cone : frame.cones) cone.id = kNoId;
    return frame;
}

}  // namespace conelane
