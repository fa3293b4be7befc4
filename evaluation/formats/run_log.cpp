#include "evaluation/formats/run_log.hpp"

#include "evaluation/formats/json_node.hpp"
#include "evaluation/formats/track_readers.hpp"
#include "evaluation/input_error.hpp"
#include "evaluation/world/track_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/core.h>

namespace conelane {
namespace {

constexpr double kPathStep_m = 0.5;         ///< a car at rest adds no places
constexpr double kMaxConeDistance_m = 6.5;  ///< from the path: the width of the widest lane
constexpr double kMinLap_m = 30.0;          ///< travel before the path may be back at its start
constexpr double kBackAtStart_m = 3.0;      ///< from the start
constexpr double kBeyondPath_m = 15.0;      ///< straight extension behind the end of the path
constexpr double kEndDirection_m = 2.0;     ///< the extension has the direction of the last metres
constexpr std::size_t kMinConesOfALap = 3;

struct DrivenLap {
    std::vector<Point> path;  ///< places kPathStep_m apart at least
    bool closed = false;
};

/// The path up to its return to the start. If it does not return, the whole path with a straight extension.
DrivenLap first_lap(std::span<const Point> path) {
    DrivenLap lap;
    for (const Point& place : path) {
        if (lap.path.empty() || (place - lap.path.back()).norm() >= kPathStep_m) lap.path.push_back(place);
    }
    if (lap.path.size() < 2) return lap;
    const Point start_direction = lap.path[1] - lap.path[0];
    double travelled_m = 0.0;
    std::optional<std::size_t> back;  ///< the place nearest to the start while the path is near it
    for (std::size_t i = 1; i < lap.path.size(); ++i) {
        const Point along = lap.path[i] - lap.path[i - 1];
        travelled_m += along.norm();
        const double away_m = (lap.path[i] - lap.path[0]).norm();
        if (travelled_m < kMinLap_m || away_m > kBackAtStart_m || along.dot(start_direction) <= 0.0) {
            if (back) break;
        } else if (!back || away_m < (lap.path[*back] - lap.path[0]).norm()) {
            back = i;
        }
    }
    if (back) {
        lap.path.resize(*back);
        lap.closed = true;
    } else {
        const Point end = lap.path.back();
        const auto before = std::find_if(lap.path.rbegin(), lap.path.rend(), [&](const Point& place) {
            return (place - end).norm() >= kEndDirection_m;
        });
        const Point along = end - (before == lap.path.rend() ? lap.path.front() : *before);
        lap.path.emplace_back(end + kBeyondPath_m * along.normalized());
    }
    return lap;
}

std::vector<Segment> segments(std::span<const Point> polyline, bool closed) {
    std::vector<Segment> result;
    for (std::size_t i = 0; i + 1 < polyline.size(); ++i) result.push_back({polyline[i], polyline[i + 1]});
    if (closed) result.push_back({polyline.back(), polyline.front()});
    return result;
}

bool any_cross(std::span<const Segment> some, std::span<const Segment> others) {
    return std::ranges::any_of(some, [&](const Segment& a) {
        return std::ranges::any_of(others, [&](const Segment& b) { return segments_cross(a, b); });
    });
}

/// A cone beside the path: arc length, side and distance.
struct PassedCone {
    std::size_t cone;
    double along_m;
    bool left;
    double off_m;
};

/// The place where the car passes a cone on the side of the cone's color, nearest to the path. Nothing if the
/// cone is too far away, behind the start, or of unknown color.
std::optional<PassedCone> passed(const Track& run, std::size_t cone, std::span<const Segment> path,
                                 bool closed) {
    const ConeColor color = run.cones[cone].color;
    if (color == ConeColor::unknown) return std::nullopt;
    const Point& position = run.cones[cone].position;
    std::optional<PassedCone> nearest;
    double before_m = 0.0;
    for (std::size_t i = 0; i < path.size(); ++i) {
        const Point along = path[i].to - path[i].from;
        const Point off = position - path[i].from;
        const bool left = cross(along, off) > 0.0;
        const double length_m = along.norm();
        const double ahead_m = along.dot(off) / length_m;
        const bool beyond_ends =
            !closed && ((i == 0 && ahead_m < 0.0) || (i + 1 == path.size() && ahead_m > length_m));
        const double on_segment_m = std::clamp(ahead_m, 0.0, length_m);
        const double off_m = (off - on_segment_m / length_m * along).norm();
        const bool own_side = is_orange(color) || left == (color == ConeColor::blue);
        if (own_side && !beyond_ends && off_m <= kMaxConeDistance_m && (!nearest || off_m < nearest->off_m)) {
            nearest = {cone, before_m + on_segment_m, left, off_m};
        }
        before_m += length_m;
    }
    return nearest;
}

/// Sets `left`, `right` and `closed` of a run by the colored cones of its last map along the driven path. If
/// they do not bound a lane, it returns false and the track stays unchanged.
bool set_boundaries_along(std::span<const Point> path, Track& run) {
    const DrivenLap lap = first_lap(path);
    if (lap.path.size() < 2) return false;
    const std::vector<Segment> driven = segments(lap.path, lap.closed);
    if (any_cross(driven, driven)) return false;

    std::vector<PassedCone> all;
    for (const MapPlace& place : run.frames.back().map) {
        if (const auto cone = passed(run, place.cone, driven, lap.closed)) all.push_back(*cone);
    }
    std::ranges::sort(all, {}, [](const PassedCone& cone) { return std::pair(cone.along_m, cone.cone); });
    Track bounded;
    bounded.cones = run.cones;
    bounded.closed = lap.closed;
    for (const PassedCone& cone : all) (cone.left ? bounded.left : bounded.right).push_back(cone.cone);
    const std::size_t fewest = lap.closed ? kMinConesOfALap : 2;
    if (bounded.left.size() < fewest || bounded.right.size() < fewest) return false;
    const TrackBoundaries lines = boundaries(bounded);
    const std::vector<Segment> left = segments(lines.left, lap.closed);
    const std::vector<Segment> right = segments(lines.right, lap.closed);
    if (any_cross(left, left) || any_cross(right, right) || any_cross(left, right)) return false;
    run.left = std::move(bounded.left);
    run.right = std::move(bounded.right);
    run.closed = lap.closed;
    return true;
}

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

constexpr TrackFormat kRunTracks{
    .word = "ftlog",
    .what = "FILE",
    .reads = "a run of ft-fsd, JSON: a scene is the map that the car had in one frame",
    .ending = ".json",
    .read = read_run_log};

}  // namespace conelane
