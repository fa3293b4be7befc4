#include "detectors/planner/lane_stretch.hpp"

#include "model/geometry.hpp"

#include <limits>
#include <numbers>
#include <utility>

namespace conelane {
namespace {

constexpr double kRight_rad = std::numbers::pi / 2.0;
/// A lane that begins so far ahead of the car, or less, begins at it.
constexpr double kAtCar_m = 0.5;
constexpr double kBesideCar_m = 2.5;  ///< and no farther aside
constexpr double kMaxJoin_m = 12.0;
/// A lane that begins ahead is joined in one bend if it is no farther aside than kBesideCar_m plus this share
/// of the distance ahead.
constexpr double kAsideShare = 0.3;
constexpr double kMinBend_m = 3.0;     ///< radius of a bend that leads to a lane that begins farther aside
constexpr double kMaxBend_rad = 2.4;   ///< and its turn
constexpr double kJoinOffset_m = 1.2;  ///< of the lane's beginning from the lane that leads to it
constexpr double kJoinTurn_rad = 0.8;
constexpr double kJoinBend_m = 2.0;  ///< before its beginning the line turns from one lane to the other
constexpr double kExtendOffset_m = 0.5;
constexpr double kExtendTurn_rad = 0.35;
constexpr double kFine_m = 0.1;
constexpr double kCurvatureOver_m = 4.0;
constexpr double kFarAside_m = 6.0;    ///< nothing farther is beside a point of a lane
constexpr double kSteadyShare = 0.5;   ///< of the way to the lane driven so far
constexpr double kSteadyFull_m = 0.5;  ///< apart: up to here all of the share, at kSteadyNone_m nothing
constexpr double kSteadyNone_m = 0.9;
constexpr double kSteadyLength_m = 12.0;  ///< of a lane is steadied; the share fades over kSteadyFade_m
constexpr double kSteadyFade_m = 4.0;
constexpr double kSteadySide_m = 1.0;  ///< to a boundary: no nearer

Point direction(double heading_rad) {
    return {std::cos(heading_rad), std::sin(heading_rad)};
}

/// What a lane knows of its boundaries, for a part of it whose arc lengths are larger by `by_m`.
void keep_knowledge(const DrivableLane& lane, double by_m, DrivableLane& part) {
    part.left_inferred = lane.left_inferred;
    part.right_inferred = lane.right_inferred;
    if (lane.trusted_m) part.trusted_m = std::clamp(*lane.trusted_m + by_m, 0.0, part.length_m);
    for (BridgedGap gap : lane.bridged) {
        gap.from_s_m = std::max(0.0, gap.from_s_m + by_m);
        gap.to_s_m = std::min(part.length_m, gap.to_s_m + by_m);
        if (gap.to_s_m > gap.from_s_m) part.bridged.push_back(gap);
    }
}

/// Points of any spacing as a lane, by arc lengths from chords, at equal steps. They begin `by_m` before
/// those of `lane`, whose knowledge the new lane keeps.
DrivableLane measured(std::vector<DrivablePoint> points, double step_m, const DrivableLane& lane,
                      double by_m = 0.0) {
    DrivableLane whole;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (i > 0) whole.length_m += (points[i].position - points[i - 1].position).norm();
        points[i].s_m = whole.length_m;
    }
    if (!(whole.length_m > 0.0)) return {};
    whole.points = std::move(points);
    DrivableLane result = stretch(whole, 0.0, whole.length_m, step_m);
    keep_knowledge(lane, by_m, result);
    return result;
}

/// Headings and curvatures of a line whose positions alone are known.
void derive(std::vector<DrivablePoint>& points, std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
        const Point& a = points[i > 0 ? i - 1 : i].position;
        const Point& b = points[i].position;
        const Point& c = points[i + 1 < points.size() ? i + 1 : i].position;
        points[i].heading_rad = turning_angle({1.0, 0.0}, c - a);
        const double product_m3 = (b - a).norm() * (c - b).norm() * (c - a).norm();
        points[i].curvature_1pm = product_m3 > 1e-9 ? 2.0 * cross(b - a, c - b) / product_m3 : 0.0;
    }
}

/// Cubic from one point and direction to another; both ends are left out.
void add_bend(std::vector<DrivablePoint>& points, const DrivablePoint& from, const DrivablePoint& to) {
    const double chord_m = (to.position - from.position).norm();
    const Point out = chord_m * direction(from.heading_rad);
    const Point in = chord_m * direction(to.heading_rad);
    const auto steps = static_cast<std::size_t>(std::ceil(chord_m / kFine_m));
    for (std::size_t i = 1; i < steps; ++i) {
        const double t = static_cast<double>(i) / static_cast<double>(steps);
        const double u = 1.0 - t;
        DrivablePoint point = between(from, to, t);
        point.position = u * u * (1.0 + 2.0 * t) * from.position + t * u * u * out +
                         t * t * (3.0 - 2.0 * t) * to.position - t * t * u * in;
        points.push_back(point);
    }
}

/// Goes along a lane and tells how far each of its points is from another lane, as far as that reaches, until
/// `tell` returns false. `window_m`: arc length that is searched past each point.
template <typename Tell>
void follow(const DrivableLane& lane, const DrivableLane& other, double window_m, Tell tell) {
    if (other.points.size() < 2) return;
    std::size_t at = 0;  // both are followed from the car on: another leg may be nearer
    for (const DrivablePoint& point : lane.points) {
        double nearest_m = std::numeric_limits<double>::infinity();
        std::size_t nearest = at;
        double parameter = 0.0;
        for (std::size_t i = at; i + 1 < other.points.size() && other.points[i].s_m <= point.s_m + window_m;
             ++i) {
            const FootPoint foot =
                foot_point(point.position, {other.points[i].position, other.points[i + 1].position});
            if (foot.distance_m < nearest_m) {
                nearest_m = foot.distance_m;
                nearest = i;
                parameter = foot.parameter;
            }
        }
        at = nearest;
        const bool before_start = nearest == 0 && parameter <= 0.0;
        const bool past_end = nearest + 2 == other.points.size() && parameter >= 1.0;
        if (past_end && point.s_m >= other.points.back().s_m - 1.0) return;
        if (!tell(point, before_start && nearest_m < window_m ? 0.0 : nearest_m)) return;
    }
}

/// Whether straight on, one bend and straight on again lead from the car to the beginning of a lane. In a
/// hairpin the inner cones beside the car may be out of view, so that the lane begins behind the bend.
bool lies_behind_bend(const Pose& pose, const DrivablePoint& first) {
    const double bend_rad = turn_rad(pose.yaw_rad, first.heading_rad);
    const double behind_m = pose.left_m(first.position) / std::sin(bend_rad);  // the corner of the two axes
    const double before_m = pose.ahead_m(first.position) - behind_m * std::cos(bend_rad);
    return std::abs(bend_rad) <= kMaxBend_rad &&
           std::min(behind_m, before_m) >= kMinBend_m * std::tan(std::abs(bend_rad) / 2.0);
}

/// The points of a lane up to a little before the beginning of another one; none if it does not lead there.
std::vector<DrivablePoint> leading_to(const DrivablePoint& beginning, const DrivableLane& lane) {
    std::vector<DrivablePoint> points;
    if (lane.points.size() < 2) return points;
    const auto foot = foot_on(lane, pose_of(beginning), 0.0, kMaxJoin_m + kBesideCar_m);
    if (!foot || foot->offset_m > kJoinOffset_m || foot->s_m >= lane.points.back().s_m + kAtCar_m) return {};
    const double turned_rad = turn_rad(point_at(lane, foot->s_m).heading_rad, beginning.heading_rad);
    if (std::abs(turned_rad) > kJoinTurn_rad) return {};
    for (const DrivablePoint& point : lane.points) {
        if (point.s_m > foot->s_m - kJoinBend_m) break;
        points.push_back(point);
    }
    if (points.empty()) points.push_back(lane.points.front());
    return points;
}

}  // namespace

double turn_rad(double from_rad, double to_rad) {
    const double rad = std::remainder(to_rad - from_rad, 2.0 * std::numbers::pi);
    return rad <= -std::numbers::pi ? std::numbers::pi : rad;
}

DrivablePoint between(const DrivablePoint& a, const DrivablePoint& b, double share) {
    DrivablePoint point;
    point.s_m = std::lerp(a.s_m, b.s_m, share);
    point.position = a.position + share * (b.position - a.position);
    point.heading_rad = turn_rad(0.0, a.heading_rad + share * turn_rad(a.heading_rad, b.heading_rad));
    point.curvature_1pm = std::lerp(a.curvature_1pm, b.curvature_1pm, share);
    point.width_left_m = std::lerp(a.width_left_m, b.width_left_m, share);
    point.width_right_m = std::lerp(a.width_right_m, b.width_right_m, share);
    return point;
}

std::optional<LaneFoot> foot_on(const DrivableLane& lane, const Pose& pose, double from_s_m, double to_s_m) {
    std::optional<LaneFoot> best;
    const std::size_t count = lane.points.size();
    for (std::size_t i = 0; i + (lane.closed ? 0 : 1) < count; ++i) {
        const DrivablePoint& a = lane.points[i];
        const DrivablePoint& b = lane.points[(i + 1) % count];
        const double end_m = i + 1 < count ? b.s_m : lane.length_m;
        if (end_m < from_s_m || a.s_m > to_s_m) continue;
        if (std::abs(turn_rad(a.heading_rad, pose.yaw_rad)) > kRight_rad) continue;
        const FootPoint foot = foot_point(pose.position, {a.position, b.position});
        if (best && best->offset_m <= foot.distance_m) continue;
        best = LaneFoot{a.s_m + foot.parameter * (end_m - a.s_m), foot.distance_m};
    }
    return best;
}

DrivablePoint point_at(const DrivableLane& lane, double s_m) {
    if (lane.closed) s_m -= lane.length_m * std::floor(s_m / lane.length_m);
    const auto after = std::ranges::upper_bound(lane.points, s_m, {}, &DrivablePoint::s_m);
    if (after == lane.points.begin()) return lane.points.front();
    const DrivablePoint& a = *(after - 1);
    if (after == lane.points.end() && !lane.closed) return a;
    DrivablePoint b = after == lane.points.end() ? lane.points.front() : *after;
    if (after == lane.points.end()) b.s_m = lane.length_m;
    const double gap_m = b.s_m - a.s_m;
    return gap_m > 0.0 ? between(a, b, std::clamp((s_m - a.s_m) / gap_m, 0.0, 1.0)) : a;
}

DrivableLane stretch(const DrivableLane& lane, double from_s_m, double to_s_m, double step_m) {
    DrivableLane part;
    if (lane.points.empty()) return part;
    const double end_m = lane.closed ? from_s_m + lane.length_m : lane.points.back().s_m;
    const double length_m = std::min(to_s_m, end_m) - from_s_m;
    if (!(length_m >= step_m)) return part;
    constexpr double kRounding = 1e-9;
    const auto steps = static_cast<std::size_t>(std::floor(length_m / step_m + kRounding));
    part.points.reserve(steps + 1);
    for (std::size_t i = 0; i <= steps; ++i) {
        const double s_m = static_cast<double>(i) * step_m;
        part.points.push_back(point_at(lane, from_s_m + s_m));
        part.points.back().s_m = s_m;
    }
    part.length_m = std::max(length_m, part.points.back().s_m);
    keep_knowledge(lane, -from_s_m, part);
    return part;
}

double jump_m(const DrivableLane& lane, const DrivableLane& other, double within_m) {
    double max_m = 0.0;
    follow(lane, other, within_m, [&](const DrivablePoint& point, double distance_m) {
        if (point.s_m <= within_m) max_m = std::max(max_m, distance_m);
        return point.s_m <= within_m;
    });
    return max_m;
}

double common_m(const DrivableLane& lane, const DrivableLane& other, double apart_m, double window_m) {
    double until_m = 0.0;
    follow(lane, other, window_m, [&](const DrivablePoint& point, double distance_m) {
        if (distance_m > apart_m) return false;
        until_m = point.s_m;
        return true;
    });
    return until_m;
}

std::optional<DrivableLane> begun_at_car(const DrivableLane& lane, const Pose& pose,
                                         const DrivableLane* before, double step_m) {
    if (lane.points.size() < 2) return std::nullopt;
    const DrivablePoint& first = lane.points.front();
    const Point offset = first.position - pose.position;
    const double ahead_m = offset.dot(direction(first.heading_rad));
    if (ahead_m <= kAtCar_m && offset.norm() <= kBesideCar_m) return lane;
    if (offset.norm() > kMaxJoin_m || pose.ahead_m(first.position) < -kBesideCar_m) return std::nullopt;
    std::vector<DrivablePoint> points;
    if (before != nullptr) points = leading_to(first, *before);
    if (points.empty()) {
        const double to_it_m = std::max(0.0, pose.ahead_m(first.position));
        const bool is_aside = std::abs(pose.left_m(first.position)) > kBesideCar_m + kAsideShare * to_it_m;
        if (is_aside && !lies_behind_bend(pose, first)) return std::nullopt;
        DrivablePoint start = first;
        start.position = pose.position;
        start.heading_rad = pose.yaw_rad;
        start.curvature_1pm = 0.0;
        points.push_back(start);
    }
    const std::size_t joined = points.size();
    add_bend(points, DrivablePoint(points.back()), first);
    const std::size_t until = points.size();
    double joined_m = 0.0;
    for (std::size_t i = 1; i < until; ++i) joined_m += (points[i].position - points[i - 1].position).norm();
    joined_m += (first.position - points.back().position).norm();
    points.insert(points.end(), lane.points.begin(), lane.points.end());
    derive(points, joined, until);
    DrivableLane result = measured(std::move(points), step_m, lane, joined_m);
    if (result.points.size() < 2) return std::nullopt;
    return result;
}

DrivableLane extended(const DrivableLane& lane, const DrivableLane& before, double step_m) {
    if (lane.points.size() < 2 || before.points.size() < 2) return lane;
    const DrivablePoint& last = lane.points.back();
    const auto foot = foot_on(before, pose_of(last), 0.0, before.points.back().s_m);
    if (!foot || foot->offset_m > kExtendOffset_m) return lane;
    if (std::abs(turn_rad(point_at(before, foot->s_m).heading_rad, last.heading_rad)) > kExtendTurn_rad)
        return lane;
    // The offset where one ends fades over some metres of the other.
    const Point offset = last.position - point_at(before, foot->s_m).position;
    constexpr double kFade_m = 5.0;
    std::vector<DrivablePoint> points = lane.points;
    for (const DrivablePoint& point : before.points) {
        const double past_m = point.s_m - foot->s_m;
        if (past_m < step_m / 2.0) continue;
        points.push_back(point);
        points.back().position += std::max(0.0, 1.0 - past_m / kFade_m) * offset;
    }
    if (points.size() == lane.points.size()) return lane;
    return measured(std::move(points), step_m, lane);
}

double arc_length_beside(const DrivableLane& lane, const Point& place, double outside_m) {
    double step_m = 0.0;
    for (std::size_t i = 0; i < lane.points.size(); ++i) {
        const DrivablePoint& point = lane.points[i];
        if (i > 0) step_m = point.s_m - lane.points[i - 1].s_m;
        if ((place - point.position).squaredNorm() > kFarAside_m * kFarAside_m) continue;
        const Pose pose = pose_of(point);
        const double left_m = pose.left_m(place);
        if (std::abs(pose.ahead_m(place)) > std::max(step_m, 0.5)) continue;
        const double width_m = left_m > 0.0 ? point.width_left_m : point.width_right_m;
        if (std::abs(left_m) <= width_m + outside_m) return point.s_m;
    }
    return std::numeric_limits<double>::infinity();
}

void even_curvatures(DrivableLane& lane) {
    std::vector<double> turned_rad(lane.points.size(), 0.0);
    for (std::size_t i = 1; i < turned_rad.size(); ++i) {
        turned_rad[i] =
            turned_rad[i - 1] + turn_rad(lane.points[i - 1].heading_rad, lane.points[i].heading_rad);
    }
    std::size_t from = 0;
    std::size_t to = 0;
    for (DrivablePoint& point : lane.points) {
        while (lane.points[from].s_m < point.s_m - kCurvatureOver_m / 2.0) ++from;
        while (to + 1 < turned_rad.size() && lane.points[to].s_m < point.s_m + kCurvatureOver_m / 2.0) ++to;
        const double over_m = lane.points[to].s_m - lane.points[from].s_m;
        if (over_m > 0.0) point.curvature_1pm = (turned_rad[to] - turned_rad[from]) / over_m;
    }
}

DrivableLane steadied(const DrivableLane& lane, const DrivableLane& before, double step_m) {
    if (lane.points.size() < 3 || before.points.size() < 2) return lane;
    std::vector<DrivablePoint> points = lane.points;
    const auto share_at = [](double left_m, double over_m) { return std::clamp(left_m / over_m, 0.0, 1.0); };
    std::size_t until = 0;
    for (std::size_t i = 0; i < points.size() && points[i].s_m < kSteadyLength_m; ++i) {
        DrivablePoint& point = points[i];
        const Pose pose = pose_of(point);
        const auto foot = foot_on(before, pose, point.s_m - kSteadyFade_m, point.s_m + kSteadyFade_m);
        if (!foot || foot->s_m <= 0.0) continue;
        const double to_left_m = pose.left_m(point_at(before, foot->s_m).position);
        const double share = kSteadyShare * share_at(kSteadyLength_m - point.s_m, kSteadyFade_m) *
                             share_at(before.length_m - foot->s_m, kSteadyFade_m) *
                             share_at(kSteadyNone_m - foot->offset_m, kSteadyNone_m - kSteadyFull_m);
        const double by_m = share * to_left_m;
        if ((by_m > 0.0 ? point.width_left_m - by_m : point.width_right_m + by_m) < kSteadySide_m) continue;
        point.position += by_m * Point(-pose.heading().y(), pose.heading().x());
        point.width_left_m -= by_m;
        point.width_right_m += by_m;
        until = i + 1;
    }
    if (until == 0) return lane;
    derive(points, 0, std::min(points.size(), until + 1));
    return measured(std::move(points), step_m, lane);
}

}  // namespace conelane
