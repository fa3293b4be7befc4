#include "detectors/planner/course_memory.hpp"

#include "detectors/drivable/smoothing_spline.hpp"
#include "detectors/planner/lane_stretch.hpp"

namespace conelane {
namespace {

/// A longer way between two frames is not known well enough to be recorded.
constexpr double kMaxGap_m = 6.0;
constexpr double kSmoothing_m = 1.0;  ///< of the closed course, see DrivableOptions::smoothing_m
/// What was recorded a lap ago is passed where the car is past it and no farther away than this.
constexpr double kPassed_m = 8.0;
constexpr double kSeamFade_m = 15.0;  ///< over which the seam between first and last lap is spread

constexpr double kNotedBehind_m = 5.0;     ///< the car: farther back, cones are those of the lap before
constexpr double kComparedAhead_m = 35.0;  ///< of the course, with the cones seen
constexpr double kBeside_m = 1.0;          ///< along the lane: a cone is beside a recorded point
constexpr double kSameNoted_m = 0.3;

/// Sets the arc lengths, from chords, and the length of a lane.
void measure(DrivableLane& lane) {
    lane.length_m = 0.0;
    for (std::size_t i = 0; i < lane.points.size(); ++i) {
        if (i > 0) lane.length_m += (lane.points[i].position - lane.points[i - 1].position).norm();
        lane.points[i].s_m = lane.length_m;
    }
    if (lane.closed) lane.length_m += (lane.points.front().position - lane.points.back().position).norm();
}

/// The recorded points as a closed lane. Where the newest ones do not meet the oldest ones, these are moved,
/// less and less with the distance.
DrivableLane closed_lane(const std::vector<DrivablePoint>& recorded) {
    DrivableLane ring;
    ring.closed = true;
    ring.points = recorded;
    const Pose from = pose_of(recorded.back());
    const Point seam =
        from.left_m(recorded.front().position) * Point(-from.heading().y(), from.heading().x());
    for (DrivablePoint& point : ring.points) {
        const double share = 1.0 - (point.s_m - recorded.front().s_m) / kSeamFade_m;
        point.position -= std::max(0.0, share) * seam;
    }
    measure(ring);
    return ring;
}

/// The same lane by a spline near points at about `step_m`, sampled finely.
DrivableLane smoothed(const DrivableLane& lane, double step_m) {
    // The spline asks for an even number of points of a closed lane, and for an odd one of an open lane.
    const auto half = static_cast<std::size_t>(std::max(2.0, std::round(lane.length_m / step_m / 2.0)));
    const double spacing_m = lane.length_m / static_cast<double>(2 * half);
    std::vector<Point> places;
    for (std::size_t i = 0; i < 2 * half + (lane.closed ? 0 : 1); ++i) {
        places.push_back(point_at(lane, static_cast<double>(i) * spacing_m).position);
    }
    const std::vector<double> weights(places.size(), 1.0);
    SmoothingSpline spline(places, weights, spacing_m, kSmoothing_m, lane.closed);
    for (int round = 0; round < 2; ++round) {
        spline =
            SmoothingSpline(places, weights, spacing_m, kSmoothing_m, lane.closed, spline.turning_1pm(0.5));
    }
    constexpr std::size_t kFiner = 4;
    DrivableLane fine;
    fine.closed = lane.closed;
    for (std::size_t i = 0; i < kFiner * 2 * half + (lane.closed ? 0 : 1); ++i) {
        const double at_m = static_cast<double>(i) * spacing_m / kFiner;
        const SmoothingSpline::Jet jet = spline.at(at_m);
        const double speed = jet.first.norm();
        DrivablePoint point = point_at(lane, at_m);
        point.position = jet.position;
        point.heading_rad = turning_angle({1.0, 0.0}, jet.first);
        point.curvature_1pm = speed > 0.0 ? cross(jet.first, jet.second) / (speed * speed * speed) : 0.0;
        fine.points.push_back(point);
    }
    measure(fine);
    return fine;
}

/// The same closed lane at equal steps that divide it.
DrivableLane evenly_spaced(const DrivableLane& ring, double step_m) {
    const double even_m = ring.length_m / std::max(3.0, std::round(ring.length_m / step_m));
    DrivableLane even = stretch(ring, 0.0, ring.length_m - even_m / 2.0, even_m);
    even.closed = true;
    even.length_m = ring.length_m;
    return even;
}

}  // namespace

void CourseMemory::move_along(const RigidShift& shift) {
    move(points_, shift);
    for (NotedCone& cone : noted_) cone.place = shift(cone.place);
}

void CourseMemory::record(const DrivableLane& lane, const ConeMemory& cones) {
    if (lane.points.empty()) return;
    const DrivablePoint& here = lane.points.front();
    if (!points_.empty()) {
        const DrivablePoint last = points_.back();
        const double gap_m = (here.position - last.position).norm();
        if (gap_m > kMaxGap_m) {
            points_.clear();
            noted_.clear();
            closed_ = false;
        } else if (pose_of(last).ahead_m(here.position) < settings_.step_m) {
            return;
        }
        const double parts = points_.empty() ? 0.0 : std::ceil(gap_m / settings_.step_m - 0.5);
        for (double i = 1.0; i < parts; ++i) append(between(last, here, i / parts), cones);
    }
    append(here, cones);
    if (closed_) {
        drop_passed(here);
    } else {
        close(lane);
    }
}

void CourseMemory::append(const DrivablePoint& point, const ConeMemory& cones) {
    const double s_m =
        points_.empty() ? 0.0 : points_.back().s_m + (point.position - points_.back().position).norm();
    points_.push_back(point);
    points_.back().s_m = s_m;
    note_cones(points_.back(), cones);
    const double first_kept_m = s_m - settings_.max_length_m;
    if (points_.front().s_m >= first_kept_m) return;
    std::erase_if(points_, [&](const DrivablePoint& old) { return old.s_m < first_kept_m; });
    closed_ = false;
}

/// The lane ahead of the car runs where the car has been, in the same direction.
void CourseMemory::close(const DrivableLane& lane) {
    const DrivablePoint here = points_.back();  // a copy, since points are erased
    for (std::size_t i = 0; i < points_.size(); ++i) {
        if (here.s_m - points_[i].s_m < settings_.min_length_m) return;
        const auto near = [&](const DrivablePoint& old, const DrivablePoint& now) {
            return (old.position - now.position).norm() <= settings_.closing_m &&
                   std::abs(turn_rad(old.heading_rad, now.heading_rad)) <= settings_.closing_rad;
        };
        if (!near(points_[i], here)) continue;
        bool same = lane.length_m >= settings_.closing_length_m;
        for (const DrivablePoint& ahead : lane.points) {
            if (!same || ahead.s_m > settings_.closing_length_m) break;
            same = std::any_of(points_.begin() + static_cast<std::ptrdiff_t>(i), points_.end(),
                               [&](const DrivablePoint& old) {
                                   return old.s_m < points_[i].s_m + 2.0 * settings_.closing_length_m &&
                                          near(old, ahead);
                               });
        }
        if (!same) continue;
        points_.erase(points_.begin(), points_.begin() + static_cast<std::ptrdiff_t>(i));
        closed_ = true;
        fit_ = 0;
        laid_ = {};
        drop_passed(here);
        return;
    }
}

void CourseMemory::drop_passed(const DrivablePoint& at) {
    const Pose pose = pose_of(at);
    std::size_t passed = 0;
    // Up to the last point of the stretch beside the car that lies behind it.
    for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
        if (points_[i].s_m - points_.front().s_m > 2.0 * kPassed_m) break;
        const Point offset = points_[i].position - at.position;
        if (offset.norm() <= kPassed_m && pose.ahead_m(points_[i].position) < settings_.step_m / 2.0)
            passed = i + 1;
    }
    points_.erase(points_.begin(), points_.begin() + static_cast<std::ptrdiff_t>(passed));
    const double first_m = points_.front().s_m - kNotedBehind_m;
    std::erase_if(noted_, [&](const NotedCone& cone) { return cone.s_m < first_m; });
}

/// All cones in the lane and a little beside it, so that a later one is known to be new.
void CourseMemory::note_cones(const DrivablePoint& here, const ConeMemory& cones) {
    const Pose pose = pose_of(here);
    for (const ConeMemory::RememberedCone& cone : cones.cones()) {
        if ((cone.position - here.position).squaredNorm() > kPassed_m * kPassed_m) continue;
        const double left_m = pose.left_m(cone.position);
        const double outside_m = std::abs(left_m) - (left_m > 0.0 ? here.width_left_m : here.width_right_m);
        if (std::abs(pose.ahead_m(cone.position)) > kBeside_m || outside_m > settings_.beside_m) continue;
        if (cone.sightings < settings_.min_sightings) continue;
        const bool is_noted = std::any_of(noted_.rbegin(), noted_.rend(), [&](const NotedCone& noted) {
            return noted.s_m > here.s_m - 3.0 * kBeside_m &&
                   (noted.place - cone.position).norm() < kSameNoted_m;
        });
        if (is_noted) continue;
        noted_.push_back({cone.position, here.s_m, std::abs(outside_m) <= settings_.boundary_m});
    }
}

void CourseMemory::observe(const Frame& frame, const ConeMemory& cones) {
    matched_ = 0;
    if (!closed_) return;
    const double gate_m = fit_ > 0 ? settings_.same_cone_m : settings_.settling_cone_m;
    std::vector<PlacePair> pairs;
    int expected = 0;
    for (NotedCone& noted : noted_) {
        if (noted.s_m > points_.front().s_m + kComparedAhead_m) break;
        const Point place = laid_(noted.place);
        const bool is_expected = cones.is_in_sure_view(place);
        const auto nearest = std::ranges::min_element(
            frame.cones, {}, [&](const Cone& cone) { return (cone.position - place).squaredNorm(); });
        if (is_expected) ++expected;
        if (nearest != frame.cones.end() && (nearest->position - place).norm() <= gate_m) {
            pairs.push_back({noted.place, nearest->position});
            noted.missed = 0;
            if (is_expected) ++matched_;
        } else if (is_expected && fit_ > 0) {
            ++noted.missed;
        }
    }
    if (expected >= settings_.min_expected) {
        fit_ = std::clamp(fit_ + (2 * matched_ > expected ? 1 : -1), -settings_.fitting_frames,
                          settings_.fitting_frames);
    }
    ShiftSettings shared;
    shared.min_shift_m = 0.0;
    if (const std::optional<RigidShift> shift = common_shift(pairs, shared)) {
        const double gain = fit_ > 0 ? settings_.kept_gain : settings_.settling_gain;
        const Point& car = frame.pose.position;
        const Point here = laid_(car);
        laid_ = {car, std::lerp(laid_.turn_rad, shift->turn_rad, gain),
                 here + gain * ((*shift)(car)-here) - car};
    }
}

void CourseMemory::lean_on(const DrivableLane& seen) {
    for (DrivablePoint& point : points_) {
        const double ahead_m = point.s_m - points_.front().s_m;
        if (ahead_m < settings_.leaning_from_m) continue;  // the lane joins the path near the car
        if (ahead_m > settings_.leaning_to_m) break;
        const Pose placed{laid_(point.position), point.heading_rad + laid_.turn_rad};
        const auto foot = foot_on(seen, placed, 0.0, seen.length_m);
        if (!foot || foot->offset_m > settings_.leaning_m) continue;
        point.position += settings_.leaning_gain * (point_at(seen, foot->s_m).position - placed.position);
    }
}

LaneTrust CourseMemory::trust(const DrivableLane& lane, const ConeMemory& cones) const {
    if (lane.points.empty()) return {0.0, "the course is not ahead of the car"};
    if (fit_ <= 0) return {0.0, "the cones do not fit the course"};
    LaneTrust trust{lane.length_m, ""};
    const auto end_before = [&](double at_m, std::string_view reason) {
        if (at_m - settings_.before_m >= trust.length_m) return;
        trust = {std::max(0.0, at_m - settings_.before_m), reason};
    };
    for (const NotedCone& noted : noted_) {
        if (noted.s_m > points_.front().s_m + kComparedAhead_m) break;
        if (noted.is_boundary && noted.missed >= settings_.missed_frames)
            end_before(arc_length_beside(lane, laid_(noted.place), settings_.boundary_m + kBeside_m),
                       "a cone of the boundary is gone");
    }
    for (const ConeMemory::RememberedCone& cone : cones.cones()) {
        if (cone.sightings < settings_.min_sightings || !cones.is_seen_lately(cone, settings_.lately_frames))
            continue;
        const bool was_there = std::ranges::any_of(noted_, [&](const NotedCone& noted) {
            return (laid_(noted.place) - cone.position).norm() <= settings_.same_cone_m;
        });
        if (!was_there)
            end_before(arc_length_beside(lane, cone.position, -settings_.in_lane_m),
                       "a cone stands in the lane");
    }
    return trust;
}

std::optional<DrivableLane> CourseMemory::course() const {
    if (!closed_ || points_.size() < 8) return std::nullopt;
    return evenly_spaced(smoothed(closed_lane(points_), settings_.step_m), step_m_);
}

DrivableLane CourseMemory::ahead(const Pose& pose, double length_m) const {
    if (!closed_ || points_.size() < 8) return {};
    DrivableLane lane;
    lane.points = points_;
    std::erase_if(lane.points,
                  [&](const DrivablePoint& point) { return point.s_m > points_.front().s_m + length_m; });
    move(lane.points, laid_);
    // It goes on from where the car was in the frame before. The laid course may begin behind that place.
    const DrivablePoint& last = points_.back();
    const auto first = std::ranges::find_if(lane.points, [&](const DrivablePoint& point) {
        return pose_of(last).ahead_m(point.position) > settings_.step_m / 2.0;
    });
    lane.points.erase(lane.points.begin(), first);
    lane.points.insert(lane.points.begin(), last);
    measure(lane);
    if (!(lane.length_m > settings_.step_m)) return {};
    lane = smoothed(lane, settings_.step_m);
    const auto foot = foot_on(lane, pose, 0.0, 2.0 * kPassed_m);
    if (!foot || foot->offset_m > settings_.line_half_width_m) return {};
    return stretch(lane, foot->s_m, lane.length_m, step_m_);
}

}  // namespace conelane
