#include "evaluation/scoring/centre_line_error.hpp"

#include "conelane/drivable_lane.hpp"
#include "conelane/invalid_input.hpp"
#include "model/geometry.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace conelane {
namespace {

/// Position relative to a centre line: distance, and heading of the line there.
struct Beside {
    double distance_m;
    double heading_rad;
};

/// Nothing if `point` is before the beginning of the line or past its end.
std::optional<Beside> beside(const Point& point, std::span<const CentreLinePoint> line) {
    std::optional<Beside> nearest;
    bool is_beyond = false;
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
        const Segment segment{line[i].position, line[i + 1].position};
        const FootPoint foot = foot_point(point, segment);
        if (nearest && nearest->distance_m <= foot.distance_m) continue;
        const double turn_rad =
            std::remainder(line[i + 1].heading_rad - line[i].heading_rad, 2.0 * std::numbers::pi);
        nearest = Beside{foot.distance_m, line[i].heading_rad + foot.parameter * turn_rad};
        const bool is_end =
            (i == 0 && foot.parameter <= 0.0) || (i + 2 == line.size() && foot.parameter >= 1.0);
        const double along_m = std::abs((point - foot.point).dot((segment.to - segment.from).normalized()));
        is_beyond = is_end && along_m > 0.5 * kCentreLineStep_m;
    }
    if (is_beyond) return std::nullopt;
    return nearest;
}

std::size_t points_of(double length_m) {
    return static_cast<std::size_t>(std::lround(length_m / kCentreLineStep_m)) + 1;
}

}  // namespace

CentreLine centre_line_of(const LaneOutline& outline, const Pose& pose, double length_m) {
    Scene scene;
    scene.pose = pose;
    Lane lane;
    lane.closed = outline.closed;
    const auto add = [&scene](const std::vector<Point>& vertices, std::vector<ConeId>& ids) {
        for (const Point& vertex : vertices) {
            ids.push_back(static_cast<ConeId>(scene.cones.size()));
            scene.cones.push_back({.id = ids.back(), .position = vertex});
        }
    };
    add(outline.left, lane.left);
    add(outline.right, lane.right);
    CentreLine line;
    if (lane.left.empty() || lane.right.empty()) return line;
    try {
        const DrivableLane driven = drivable(lane, scene, {.step_m = kCentreLineStep_m});
        const std::size_t count = std::min(points_of(length_m), driven.points.size());
        line.reserve(count);
        for (const DrivablePoint& point : std::span(driven.points).first(count))
            line.push_back({point.position, point.heading_rad});
    } catch (const InvalidInput&) {
        line.clear();  // for example a boundary of 20 km: nothing can be driven
    }
    return line;
}

CentreLine centre_line_of(std::span<const Point> polyline, const Pose& pose, double length_m) {
    CentreLine line;
    if (polyline.size() < 2) return line;
    const PolylineFoot foot = foot_on_polyline(pose.position, polyline);
    std::size_t segment = foot.segment;
    Point at = foot.point;
    double left_m = 0.0;  // distance to the next point of the line
    const std::size_t most = points_of(length_m);
    while (line.size() < most && segment + 1 < polyline.size()) {
        const Point way = polyline[segment + 1] - at;
        const double way_m = way.norm();
        if (way_m <= left_m) {
            left_m -= way_m;
            at = polyline[++segment];
            continue;
        }
        at += left_m / way_m * way;
        line.push_back({at, std::atan2(way.y(), way.x())});
        left_m = kCentreLineStep_m;
    }
    return line;
}

CentreLineError centre_line_error(std::span<const CentreLinePoint> lane,
                                  std::span<const CentreLinePoint> truth) {
    CentreLineError error;
    const std::size_t count = std::min(points_of(kCentreLineStretch_m), lane.size());
    const std::size_t heading_at = points_of(kHeadingAt_m) - 1;
    for (std::size_t i = 0; i < count; ++i) {
        const std::optional<Beside> true_line = beside(lane[i].position, truth);
        if (!true_line) continue;
        error.lateral_m.push_back(static_cast<float>(true_line->distance_m));
        if (i == heading_at) {
            error.heading_rad = std::abs(
                std::remainder(lane[i].heading_rad - true_line->heading_rad, 2.0 * std::numbers::pi));
        }
    }
    return error;
}

bool is_steady(std::span<const CentreLinePoint> before, std::span<const CentreLinePoint> now) {
    std::size_t compared = 0;
    for (const CentreLinePoint& point : now) {
        const std::optional<Beside> earlier = beside(point.position, before);
        if (!earlier) continue;
        if (earlier->distance_m > kSteady_m) return false;
        if (++compared == points_of(kSteadyStretch_m)) break;
    }
    return compared > 0;
}

}  // namespace conelane
