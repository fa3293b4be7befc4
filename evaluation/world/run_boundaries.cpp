#include "evaluation/world/run_boundaries.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

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

}  // namespace

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

}  // namespace conelane
