#include "experiments/race/course.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/seeded_random.hpp"
#include "evaluation/world/centre_line.hpp"

#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_01.hpp>
#include <boost/random/uniform_real_distribution.hpp>

namespace conelane::experiments {
namespace {

constexpr double kPi = std::numbers::pi;

void add_cone(RaceCourse& course, double x_m, double y_m, ConeColor color) {
    course.cones.push_back({static_cast<ConeId>(course.cones.size()), {x_m, y_m}, color});
}

/// Both sides of a lane along the x axis.
void add_pair(RaceCourse& course, double x_m, double half_width_m, ConeColor left, ConeColor right) {
    add_cone(course, x_m, half_width_m, left);
    add_cone(course, x_m, -half_width_m, right);
}

/// A line that is driven once, made of straights and arcs.
class LineMaker {
  public:
    LineMaker(const Pose& start, double step_m) : pose_(start), step_m_(step_m) {}

    /// `curvature_1pm` is positive in a left bend.
    void go(double length_m, double curvature_1pm) {
        const Pose begin = pose_;
        const auto at = [&](double s_m) {
            Pose pose = begin;
            pose.yaw_rad += curvature_1pm * s_m;
            if (curvature_1pm == 0.0) {
                pose.position += s_m * begin.heading();
            } else {
                pose.position += Point(std::sin(pose.yaw_rad) - std::sin(begin.yaw_rad),
                                       std::cos(begin.yaw_rad) - std::cos(pose.yaw_rad)) /
                                 curvature_1pm;
            }
            return pose;
        };
        for (; next_m_ <= passed_m_ + length_m + 1e-9; next_m_ += step_m_) {
            poses_.push_back(at(next_m_ - passed_m_));
        }
        passed_m_ += length_m;
        pose_ = at(length_m);
    }
    [[nodiscard]] std::vector<Pose> take() { return std::move(poses_); }

  private:
    Pose pose_;
    double step_m_;
    double passed_m_ = 0.0;
    double next_m_ = 0.0;
    std::vector<Pose> poses_;
};

constexpr double kBehind_m = 20.0;  ///< length behind the start line at which the lines of missions begin

constexpr double kAccelerationHalfWidth_m = 1.9;
constexpr double kAcceleration_m = 75.0;
constexpr double kAccelerationRest_m = 100.0;

constexpr double kSkidpadRadius_m = 9.125;
constexpr double kSkidpadInner_m = 15.25 / 2.0;
constexpr double kSkidpadOuter_m = 21.25 / 2.0;
constexpr double kSkidpadHalfWidth_m = 1.5;
constexpr double kSkidpadRest_m = 25.0;

RaceCourse acceleration_shape() {
    RaceCourse course;
    course.name = "acceleration";
    course.mission = Mission::acceleration;
    LineMaker line({{-kBehind_m, 0.0}, 0.0}, course.step_m);
    line.go(kBehind_m + kAcceleration_m + kAccelerationRest_m + 10.0, 0.0);
    course.line = line.take();
    course.half_width_m = kAccelerationHalfWidth_m;
    course.start_m = kBehind_m - 2.0;
    course.finish_m = kBehind_m + kAcceleration_m;
    course.rest_m = kAccelerationRest_m;
    return course;
}

RaceCourse skidpad_shape() {
    RaceCourse course;
    course.name = "skidpad";
    course.mission = Mission::skidpad;
    const double two_rounds_m = 4.0 * kPi * kSkidpadRadius_m;
    LineMaker line({{-kBehind_m, 0.0}, 0.0}, course.step_m);
    line.go(kBehind_m, 0.0);
    line.go(two_rounds_m, -1.0 / kSkidpadRadius_m);
    line.go(two_rounds_m, 1.0 / kSkidpadRadius_m);
    line.go(kSkidpadRest_m + 10.0, 0.0);
    course.line = line.take();
    course.half_width_m = kSkidpadHalfWidth_m;
    course.start_m = kBehind_m - 16.0;
    course.finish_m = kBehind_m + 2.0 * two_rounds_m;
    course.rest_m = kSkidpadRest_m;
    course.phases = {"approach", "right 1", "right 2", "left 1", "left 2", "exit"};
    return course;
}

/// A place on a circle around the middle of the right (-1) or left (1) circle of a skidpad, from where the
/// car enters it.
Point on_circle(double side, double radius_m, double angle_rad) {
    const Point direction(std::sin(angle_rad), -side * std::cos(angle_rad));
    return Point(0.0, side * kSkidpadRadius_m) + radius_m * direction;
}

/// In the right circle, the inner cones are on the right of the car, so they are yellow.
ConeColor inner_color(double side) {
    return side < 0.0 ? ConeColor::yellow : ConeColor::blue;
}

ConeColor outer_color(double side) {
    return inner_color(-side);
}

/// Draws the properties that the rules of an event leave open.
class Variation {
  public:
    Variation(Mission mission, std::uint64_t seed)
        : random_(generator_of("varied " + std::string(to_string(mission)), seed)),
          jitter_m_(number(0.0, 0.2)),
          missing_(number(0.0, 0.08)) {}

    double number(double low, double high) {
        return boost::random::uniform_real_distribution<double>(low, high)(random_);
    }
    int count(int low, int high) { return boost::random::uniform_int_distribution<int>(low, high)(random_); }
    bool chance(double share) { return boost::random::uniform_01<double>()(random_) < share; }

    /// Places a cone near its nominal place, or leaves it out.
    void set(RaceCourse& course, const Point& place, ConeColor color) {
        if (!chance(missing_)) set_surely(course, place, color);
    }
    void set_surely(RaceCourse& course, const Point& place, ConeColor color) {
        boost::random::normal_distribution<double> normal(0.0, 0.5);
        const auto off_m = [&] { return jitter_m_ * std::clamp(normal(random_), -1.5, 1.5); };
        const double x_m = off_m();
        const double y_m = off_m();
        add_cone(course, place.x() + x_m, place.y() + y_m, color);
    }
    void set_pair(RaceCourse& course, double x_m, double half_width_m, ConeColor left, ConeColor right) {
        set(course, {x_m, half_width_m}, left);
        set(course, {x_m, -half_width_m}, right);
    }

  private:
    boost::random::mt19937_64 random_;
    double jitter_m_;
    double missing_;
};

/// Cones that do not belong to the lane: at least `clear_m` from its centre line.
void strew(Variation& vary, RaceCourse& course, int count, double clear_m, const Point& low,
           const Point& high) {
    for (int i = 0; i < count; ++i) {
        const double x_m = vary.number(low.x(), high.x());
        const double y_m = vary.number(low.y(), high.y());
        const Point place(x_m, y_m);
        const bool clear = std::ranges::all_of(
            course.line, [&](const Pose& pose) { return (pose.position - place).norm() > clear_m; });
        if (clear) add_cone(course, x_m, y_m, ConeColor::unknown);
    }
}

/// A row of cones across the lane.
void close_exit(Variation& vary, RaceCourse& course, double x_m, double half_width_m) {
    const int cones = vary.count(3, 5);
    for (int i = 0; i < cones; ++i) {
        const double y_m = half_width_m * (2.0 * i / (cones - 1) - 1.0);
        vary.set_surely(course, {x_m, y_m}, ConeColor::orange);
    }
}

RaceCourse varied_acceleration(std::uint64_t seed) {
    RaceCourse course = acceleration_shape();
    Variation vary(course.mission, seed);
    const double half_m = vary.number(1.5, 2.5);
    course.half_width_m = half_m;
    course.start_m = kBehind_m + vary.number(-3.0, -0.3);
    const double spacing_m = vary.number(4.0, 6.0);
    const double gate_half_m = vary.number(0.25, 0.6);
    const double wider_m = vary.chance(0.3) ? vary.number(0.0, 0.4) : 0.0;  // setback of the big cones
    const ConeColor gate_color = vary.chance(0.3) ? ConeColor::unknown : ConeColor::orange;
    const bool has_start_gate = vary.chance(0.85);
    for (double x_m = has_start_gate ? spacing_m : 0.0; x_m < kAcceleration_m - 1.5; x_m += spacing_m) {
        vary.set_pair(course, x_m, half_m, ConeColor::blue, ConeColor::yellow);
    }
    for (const double offset_m : {-gate_half_m, gate_half_m}) {
        if (has_start_gate) vary.set_pair(course, offset_m, half_m + wider_m, gate_color, gate_color);
        for (const double side : {1.0, -1.0}) {
            vary.set_surely(course, {kAcceleration_m + offset_m, side * (half_m + wider_m)}, gate_color);
        }
    }
    const int exit = vary.count(0, 2);  // 0: no cones, 1: cones at the sides, 2: also closed
    const double exit_m = kAcceleration_m + vary.number(60.0, 100.0);
    if (exit > 0) {
        for (double x_m = kAcceleration_m + spacing_m; x_m < exit_m; x_m += spacing_m) {
            vary.set_pair(course, x_m, half_m, ConeColor::orange, ConeColor::orange);
        }
    }
    if (exit == 2) {
        close_exit(vary, course, exit_m, half_m);
        course.rest_m = exit_m - kAcceleration_m;
    }
    if (vary.chance(0.3)) {  // where cars wait
        for (const double x_m : {-8.0, -5.0}) {
            vary.set_pair(course, x_m, half_m, ConeColor::orange, ConeColor::orange);
        }
    }
    strew(vary, course, vary.count(0, 10), half_m + 1.0, {-5.0, -10.0}, {130.0, 10.0});
    return course;
}

RaceCourse varied_skidpad(std::uint64_t seed) {
    RaceCourse course = skidpad_shape();
    Variation vary(course.mission, seed);
    course.start_m = kBehind_m + vary.number(-17.0, -14.0);
    const double wider_m = vary.number(0.0, 0.2);  // if measured to the edges of cones
    const double inner_m = kSkidpadInner_m - wider_m;
    const double outer_m = kSkidpadOuter_m + wider_m;
    const double half_m = kSkidpadHalfWidth_m + wider_m;
    const bool has_outer = vary.chance(0.85);
    const int outer_places = vary.chance(0.7) ? 16 : vary.count(14, 20);
    // Places along the ring, turned by a random angle.
    const double turned = vary.chance(0.5) ? 0.0 : vary.number(0.0, 1.0);
    for (const double side : {-1.0, 1.0}) {
        for (int i = 0; i < 16; ++i) {
            vary.set(course, on_circle(side, inner_m, 2.0 * kPi * (i + turned) / 16), inner_color(side));
        }
        for (int i = 0; i < outer_places && has_outer; ++i) {
            const Point place = on_circle(side, outer_m, 2.0 * kPi * (i + turned) / outer_places);
            const bool in_other_lane = side * place.y() < half_m - 0.05;
            if (!in_other_lane) vary.set(course, place, outer_color(side));
        }
    }
    const double lane_half_m = half_m + vary.number(0.0, 0.15);
    if (vary.chance(0.8)) {
        const double spacing_m = vary.number(2.5, 5.0);
        const double to_m = vary.number(9.0, 11.5);
        for (int i = vary.count(1, 4); i >= 0; --i) {
            vary.set_pair(course, -to_m - i * spacing_m, lane_half_m, ConeColor::orange, ConeColor::orange);
        }
    }
    const double exit_m = vary.number(19.0, 25.0);
    if (vary.chance(0.8)) {
        const double spacing_m = vary.number(2.5, 5.0);
        for (double x_m = vary.number(9.0, 11.5); x_m < exit_m; x_m += spacing_m) {
            vary.set_pair(course, x_m, lane_half_m, ConeColor::orange, ConeColor::orange);
        }
    }
    if (vary.chance(0.5)) {
        close_exit(vary, course, exit_m, lane_half_m);
        course.rest_m = exit_m;
    }
    const double gate_half_m = half_m + vary.number(0.1, 0.5);
    const ConeColor gate_color = vary.chance(0.3) ? ConeColor::unknown : ConeColor::orange;
    if (vary.chance(0.8)) {
        const double gate_m = vary.number(0.3, 1.5);
        for (const double x_m : {-gate_m, gate_m}) {
            vary.set_pair(course, x_m, gate_half_m, gate_color, gate_color);
        }
    }
    strew(vary, course, vary.count(0, 10), half_m + 1.0, {-25.0, -25.0}, {30.0, 25.0});
    return course;
}

void measure(RaceCourse& course) {
    std::vector<Point> points;
    for (const Pose& pose : course.line) points.push_back(pose.position);
    course.length_m = polyline_length_m(points, course.closed);
}

bool crosses(const std::vector<Point>& boundary, const Segment& way) {
    for (std::size_t i = 0; i < boundary.size(); ++i) {
        const Segment edge{boundary[i], boundary[(i + 1) % boundary.size()]};
        // Skips the boundary points that are far away, which are most of them.
        if ((edge.from - way.from).squaredNorm() > 400.0 && (edge.to - way.from).squaredNorm() > 400.0 &&
            (edge.to - edge.from).squaredNorm() < 100.0) {
            continue;
        }
        if (segments_intersect(edge, way)) return true;
    }
    return false;
}

bool is_inside(const std::vector<Point>& polygon, const Point& point) {
    bool inside = false;
    for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
        const Point& a = polygon[i];
        const Point& b = polygon[j];
        if ((a.y() > point.y()) != (b.y() > point.y()) &&
            point.x() < (b.x() - a.x()) * (point.y() - a.y()) / (b.y() - a.y()) + a.x()) {
            inside = !inside;
        }
    }
    return inside;
}

}  // namespace

RaceCourse circuit(const Track& track) {
    if (!track.closed || !track.driven.empty()) {
        throw InvalidInput("tracks", "'" + track.name + "' is not a closed course with boundaries");
    }
    RaceCourse course;
    course.name = track.name;
    course.cones = track.cones;
    for (const auto* const side : {&track.left, &track.right}) {
        const ConeColor color = side == &track.left ? ConeColor::blue : ConeColor::yellow;
        for (const std::size_t i : *side) {
            if (!is_orange(course.cones[i].color)) course.cones[i].color = color;
        }
    }
    course.closed = true;
    course.lane = boundaries(track);
    course.line = centre_line_poses(course.lane, course.step_m);
    course.rest_m = 30.0;
    measure(course);
    return course;
}

RaceCourse acceleration_course() {
    RaceCourse course = acceleration_shape();
    for (int i = 1; i < 15; ++i) {
        add_pair(course, 5.0 * i, kAccelerationHalfWidth_m, ConeColor::blue, ConeColor::yellow);
    }
    for (const double gate_m : {0.0, kAcceleration_m}) {
        for (const double offset_m : {-0.3, 0.3}) {
            add_pair(course, gate_m + offset_m, kAccelerationHalfWidth_m, ConeColor::orange,
                     ConeColor::orange);
        }
    }
    for (int i = 16; i <= 35; ++i) {
        add_pair(course, 5.0 * i, kAccelerationHalfWidth_m, ConeColor::orange, ConeColor::orange);
    }
    measure(course);
    return course;
}

RaceCourse skidpad_course() {
    RaceCourse course = skidpad_shape();
    constexpr int kConesPerCircle = 16;
    for (const double side : {-1.0, 1.0}) {
        for (int i = 0; i < kConesPerCircle; ++i) {
            const double angle_rad = 2.0 * kPi * i / kConesPerCircle;
            const Point inner = on_circle(side, kSkidpadInner_m, angle_rad);
            const Point outer = on_circle(side, kSkidpadOuter_m, angle_rad);
            add_cone(course, inner.x(), inner.y(), inner_color(side));
            // Outer cones inside the lane of entry, exit or the other circle are left out.
            if (std::abs(outer.y()) > kSkidpadHalfWidth_m + 0.1 && side * outer.y() > 0.0)
                add_cone(course, outer.x(), outer.y(), outer_color(side));
        }
    }
    const double junction_m =
        std::sqrt(kSkidpadOuter_m * kSkidpadOuter_m - std::pow(kSkidpadRadius_m - kSkidpadHalfWidth_m, 2.0));
    for (const double x_m : {-junction_m, junction_m}) {
        add_pair(course, x_m, kSkidpadHalfWidth_m, ConeColor::yellow, ConeColor::blue);
    }
    for (const double x_m : {-20.0, -15.0, -11.25, 11.0, 16.0, 21.0, 25.0}) {
        add_pair(course, x_m, kSkidpadHalfWidth_m, ConeColor::orange, ConeColor::orange);
    }
    for (const double x_m : {-1.3, 1.3}) add_pair(course, x_m, 2.0, ConeColor::orange, ConeColor::orange);
    add_cone(course, 25.0, 0.0, ConeColor::orange);
    measure(course);
    return course;
}

RaceCourse mission_course(Mission mission) {
    return mission == Mission::skidpad ? skidpad_course() : acceleration_course();
}

RaceCourse mission_course(Mission mission, const Track& track) {
    RaceCourse course = mission == Mission::skidpad ? skidpad_shape() : acceleration_shape();
    course.name = track.name;
    course.cones = track.cones;
    if (mission == Mission::acceleration) {
        std::vector<double> aside_m;
        for (const std::vector<std::size_t>* side : {&track.left, &track.right}) {
            for (const std::size_t i : *side) aside_m.push_back(std::abs(track.cones[i].position.y()));
        }
        if (!aside_m.empty()) {
            const auto middle = aside_m.begin() + static_cast<std::ptrdiff_t>(aside_m.size() / 2);
            std::ranges::nth_element(aside_m, middle);
            course.half_width_m = *middle;
        }
    }
    measure(course);
    return course;
}

RaceCourse varied_mission_course(Mission mission, std::uint64_t seed) {
    RaceCourse course = mission == Mission::skidpad ? varied_skidpad(seed) : varied_acceleration(seed);
    course.name = "varied " + course.name;
    measure(course);
    return course;
}

void CourseFoot::follow(const Point& point, double reach_m) {
    const auto steps = static_cast<long>(std::ceil(reach_m / course_.step_m));
    const auto middle = static_cast<long>(std::floor(at_m_ / course_.step_m));
    double best_m = std::numeric_limits<double>::infinity();
    double best_at_m = at_m_;
    for (long i = middle - steps; i <= middle + steps; ++i) {
        const auto from = place(i);
        const auto to = place(i + 1);
        if (!from || !to) continue;
        const FootPoint foot = foot_point(point, {*from, *to});
        if (foot.distance_m >= best_m) continue;
        best_m = foot.distance_m;
        best_at_m = (static_cast<double>(i) + foot.parameter) * course_.step_m;
    }
    distance_m_ = best_m;
    at_m_ = best_at_m;
}

std::optional<Point> CourseFoot::place(long number) const {
    const auto size = static_cast<long>(course_.line.size());
    if (course_.closed)
        return course_.line[static_cast<std::size_t>(((number % size) + size) % size)].position;
    if (number < 0 || number >= size) return std::nullopt;
    return course_.line[static_cast<std::size_t>(number)].position;
}

bool stays_in_ring(const TrackBoundaries& lane, const Segment& way) {
    if (crosses(lane.left, way) || crosses(lane.right, way)) return false;
    return is_inside(lane.left, way.to) != is_inside(lane.right, way.to);
}

bool leaves(const RaceCourse& course, const std::vector<Point>& path, double up_to_m, CourseFoot at) {
    double along_m = 0.0;
    for (std::size_t i = 1; i < path.size(); ++i) {
        const double step_m = (path[i] - path[i - 1]).norm();
        along_m += step_m;
        if (along_m > up_to_m) return false;
        if (course.half_width_m) {
            at.follow(path[i], 2.0 + step_m);
            if (at.distance_m() > *course.half_width_m) return true;
        } else if (!stays_in_ring(course.lane, {path[i - 1], path[i]})) {
            return true;
        }
    }
    return false;
}

}  // namespace conelane::experiments
