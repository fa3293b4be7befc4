#include "conelane/drivable_lane.hpp"

#include "conelane/invalid_input.hpp"
#include "detectors/drivable/drivable_answers.hpp"
#include "detectors/drivable/lane_rungs.hpp"
#include "detectors/drivable/smoothing_spline.hpp"

#include <array>
#include <utility>

namespace conelane {
namespace {

constexpr double kMaxConeDistance_m = 1e6;
constexpr double kMaxBoundary_m = 2e4;
/// Smallest distance of the spline from a boundary at a rung; between rungs, half their spacing less.
constexpr double kClearance_m = 0.25;
/// The lane is too narrow if a rung's middle is nearer to a boundary than this.
constexpr double kMinHalfWidth_m = 0.4;
/// Length of the part of a boundary that belongs to a rung, to either side: parts farther along it, such as
/// the next leg of a hairpin, do not count.
constexpr double kReach_m = 12.0;
constexpr double kSlowest = 0.1;  ///< below it the spline has a cusp; 1 is a spline measured by arc length
constexpr int kRounds = 20;
constexpr int kTurningRounds = 3;  ///< minimum: each round takes its expected turning from the round before
/// Sharper bends are smoothed more if there is room. Outer hairpins of 9 m give 1 / (3 m).
constexpr double kSharpest_1pm = 0.4;
constexpr int kSharpRounds = 8;  ///< after these rounds, only staying in the lane counts
constexpr double kSharpFactor = 0.4;
constexpr std::size_t kSharpReach = 4;  ///< rungs to either side of a sharp one that get less weight
constexpr double kMissedFactor = 6.0;
constexpr std::size_t kMissedReach = 2;  ///< rungs to either side of a missed one that get more weight

void validate(const DrivableOptions& options) {
    const auto require = [](double value, double least, double most, const char* key) {
        if (value >= least && value <= most) return;
        throw InvalidInput(key, "must be in [" + std::to_string(least) + ", " + std::to_string(most) + "]");
    };
    require(options.step_m, 0.01, 100.0, "step_m");
    require(options.smoothing_m, 0.25, 5.0, "smoothing_m");
    require(options.default_width_m, 1.0, kMaxLaneWidth_m, "default_width_m");
    if (!(options.max_gap_m > 0.0)) throw InvalidInput("max_gap_m", "must be above 0");
}

struct Sides {
    std::vector<Point> left;
    std::vector<Point> right;
};

/// The cones of a lane, relative to the car's position.
Sides positions(const Lane& lane, const Scene& scene) {
    if (!scene.pose.position.allFinite()) throw InvalidInput("pose", "has a position that is not finite");
    if (!std::isfinite(scene.pose.yaw_rad)) throw InvalidInput("pose.yaw", "is not finite");
    struct Wanted {
        ConeId id;
        bool on_left;
        std::size_t index;
        bool found = false;
    };
    std::vector<Wanted> wanted;
    for (std::size_t i = 0; i < lane.left.size(); ++i) wanted.push_back({lane.left[i], true, i});
    for (std::size_t i = 0; i < lane.right.size(); ++i) wanted.push_back({lane.right[i], false, i});
    std::ranges::stable_sort(wanted, {}, &Wanted::id);
    const auto refuse = [](const Wanted& cone, const std::string& reason) {
        throw InvalidInput((cone.on_left ? "left[" : "right[") + std::to_string(cone.index) + "]",
                           "cone " + std::to_string(cone.id) + " " + reason);
    };
    for (std::size_t i = 1; i < wanted.size(); ++i) {
        if (wanted[i].id == wanted[i - 1].id) refuse(wanted[i], "is in the lane twice");
    }
    Sides sides{std::vector<Point>(lane.left.size()), std::vector<Point>(lane.right.size())};
    for (const Cone& cone : scene.cones) {
        const auto place = std::ranges::lower_bound(wanted, cone.id, {}, &Wanted::id);
        if (place == wanted.end() || place->id != cone.id) continue;
        if (place->found) refuse(*place, "is in the scene twice");
        const Point relative = cone.position - scene.pose.position;
        if (!(relative.cwiseAbs().maxCoeff() <= kMaxConeDistance_m)) {
            refuse(*place, "is not finite or farther than 1000 km from the car");
        }
        place->found = true;
        (place->on_left ? sides.left : sides.right)[place->index] = relative;
    }
    for (const Wanted& cone : wanted) {
        if (!cone.found) refuse(cone, "is not in the scene");
    }
    return sides;
}

void require_boundary(const LaneBoundary& boundary, bool closed, const char* key) {
    if (closed && boundary.vertices().size() < 3) {
        throw InvalidInput(key, "has fewer than three cones, but the lane is closed");
    }
    if (boundary.length_m() > kMaxBoundary_m) throw InvalidInput(key, "is longer than 20 km");
}

/// Fills an empty side from the other one. Returns whether it did.
bool infer(std::vector<Point>& empty, const std::vector<Point>& known, bool known_is_left, bool closed,
           const DrivableOptions& options) {
    if (!empty.empty() || known.empty() || closed) return false;
    const LaneBoundary boundary(known, false);
    require_boundary(boundary, false, known_is_left ? "left" : "right");
    empty = inferred_boundary(boundary, known_is_left, options.default_width_m);
    return !empty.empty();
}

/// The smoothed centre line of a lane with both boundaries, in the coordinates of the boundaries. Parameters
/// are those of the spline; arc lengths begin at its first rung.
class CentreLine {
  public:
    CentreLine(RungLadder ladder, double smoothing_m, const TimeCheck& check_time)
        : ladder_(std::move(ladder)), spline_(fit(smoothing_m, check_time)) {
        check_time();
        measure();
    }

    /// Arc length of the foot point of the origin.
    [[nodiscard]] double foot_m(const Point& heading) const;
    /// Arc length from a place to the first rung at or behind it without a lane, else to the end of an open
    /// line, or around a closed one; 0 if the place itself has no lane.
    [[nodiscard]] double usable_length_m(double from_m) const;
    [[nodiscard]] double length_m() const { return arc_m_.back(); }
    [[nodiscard]] bool closed() const { return ladder_.left.closed(); }
    /// The point at an arc length, which wraps on a closed line. A width is absent if its boundary is on the
    /// wrong side or nearer than allowed.
    [[nodiscard]] DrivablePoint at(double arc_m) const;
    /// The gaps longer than `max_gap_m`, by arc length from the first rung.
    [[nodiscard]] std::vector<BridgedGap> gaps(double max_gap_m) const;

  private:
    [[nodiscard]] std::size_t count() const { return ladder_.rungs.size(); }
    [[nodiscard]] std::size_t cells() const { return arc_m_.size() - 1; }
    [[nodiscard]] double parameter(std::size_t rung) const {
        return static_cast<double>(rung) * ladder_.spacing_m;
    }
    SmoothingSpline fit(double smoothing_m, const TimeCheck& check_time);
    void measure();
    [[nodiscard]] double arc_between(double from, double to) const;
    [[nodiscard]] double parameter_at(double arc_m) const;
    [[nodiscard]] double width_m(const LaneBoundary& boundary, double place_m, const Point& from,
                                 const Point& normal, double max_m) const;
    void add_gaps(const LaneBoundary& boundary, bool on_left, double max_gap_m,
                  std::vector<BridgedGap>& gaps) const;

    RungLadder ladder_;
    std::vector<double>
        room_m_;  ///< largest distance of the spline from the middle, by rung; negative: no lane
    SmoothingSpline spline_;
    std::vector<bool> usable_;   ///< at each rung
    std::vector<double> arc_m_;  ///< at each rung; for a closed line also back at the first one
};

/// A spline that stays within room_m_ of every middle keeps its clearance, because no point within that
/// distance of a middle is too near to a boundary. If it does not, the middles around that rung get more
/// weight in the next round: the spline then comes nearer to them there and stays smooth elsewhere. If it
/// bends too sharply, they get less.
SmoothingSpline CentreLine::fit(double smoothing_m, const TimeCheck& check_time) {
    std::vector<Point> middles;
    for (const Rung& rung : ladder_.rungs) {
        middles.push_back(rung.middle());
        const double half_m = std::min(ladder_.left.distance_m(middles.back(), rung.left_m, kReach_m),
                                       ladder_.right.distance_m(middles.back(), rung.right_m, kReach_m));
        room_m_.push_back(half_m >= kMinHalfWidth_m ? half_m - kClearance_m : -1.0);
    }
    const std::size_t n = count();
    std::vector<double> weights(n, 1.0);
    SmoothingSpline spline(middles, weights, ladder_.spacing_m, smoothing_m, closed());
    std::vector<double> factors(n);
    const auto spread = [&](std::size_t k, std::size_t reach, double factor) {
        for (std::size_t d = 0; d <= reach; ++d) {
            if (closed() || k + d < n) factors[(k + d) % n] = factor;
            if (closed() || k >= d) factors[(k + n - d) % n] = factor;
        }
    };
    for (int round = 0; round < kRounds; ++round) {
        check_time();
        bool good = true;
        std::fill(factors.begin(), factors.end(), 1.0);
        for (std::size_t k = 0; round < kSharpRounds && k < n; ++k) {
            const SmoothingSpline::Jet jet = spline.at(parameter(k));
            const double speed = jet.first.norm();
            if (std::abs(cross(jet.first, jet.second)) <= kSharpest_1pm * speed * speed * speed) continue;
            good = false;
            spread(k, kSharpReach, kSharpFactor);
        }
        for (std::size_t k = 0; k < n; ++k) {
            const double off_m = (spline.at(parameter(k)).position - middles[k]).norm();
            if (room_m_[k] < 0.0 || off_m <= room_m_[k]) continue;
            good = false;
            spread(k, kMissedReach, kMissedFactor);
        }
        if (good && round >= kTurningRounds) break;
        for (std::size_t k = 0; k < n; ++k) weights[k] *= factors[k];
        const std::vector<double> turning_1pm = spline.turning_1pm(kSharpest_1pm);
        spline = SmoothingSpline(middles, weights, ladder_.spacing_m, smoothing_m, closed(), turning_1pm);
    }
    return spline;
}

void CentreLine::measure() {
    for (std::size_t k = 0; k < count(); ++k) {
        const Rung& rung = ladder_.rungs[k];
        const SmoothingSpline::Jet jet = spline_.at(parameter(k));
        usable_.push_back((jet.position - rung.middle()).norm() <= room_m_[k] &&
                          jet.first.norm() >= kSlowest && cross(jet.first, rung.left - rung.right) > 0.0);
    }
    arc_m_.push_back(0.0);
    for (std::size_t k = 0; k + (closed() ? 0 : 1) < count(); ++k) {
        arc_m_.push_back(arc_m_.back() + arc_between(parameter(k), parameter(k + 1)));
    }
}

/// Gauss-Legendre quadrature with three nodes, between two rungs.
double CentreLine::arc_between(double from, double to) const {
    constexpr double kNode = 0.7745966692414834;
    const double half = 0.5 * (to - from);
    const double middle = from + half;
    const auto speed = [this](double at) { return spline_.at(at).first.norm(); };
    return half *
           (5.0 * speed(middle - kNode * half) + 8.0 * speed(middle) + 5.0 * speed(middle + kNode * half)) /
           9.0;
}

double CentreLine::parameter_at(double arc_m) const {
    if (closed()) arc_m -= length_m() * std::floor(arc_m / length_m());
    const auto after = std::upper_bound(arc_m_.begin() + 1, arc_m_.end() - 1, arc_m);
    const auto k = static_cast<std::size_t>(after - arc_m_.begin()) - 1;
    const double start = parameter(k);
    const double cell_m = arc_m_[k + 1] - arc_m_[k];
    const double wanted_m = std::clamp(arc_m - arc_m_[k], 0.0, cell_m);
    if (!(cell_m > 0.0)) return start;
    double at = start + ladder_.spacing_m * wanted_m / cell_m;
    const double speed = spline_.at(at).first.norm();
    if (speed >= kSlowest) at -= (arc_between(start, at) - wanted_m) / speed;
    return std::clamp(at, start, start + ladder_.spacing_m);
}

double CentreLine::foot_m(const Point& heading) const {
    std::size_t nearest = 0;
    double nearest_m2 = std::numeric_limits<double>::infinity();
    for (const bool along_only : {true, false}) {
        for (std::size_t k = 0; k < count(); ++k) {
            const SmoothingSpline::Jet jet = spline_.at(parameter(k));
            if (along_only && jet.first.dot(heading) < 0.0) continue;
            const double distance_m2 = jet.position.squaredNorm();
            if (distance_m2 < nearest_m2) {
                nearest_m2 = distance_m2;
                nearest = k;
            }
        }
        if (nearest_m2 < std::numeric_limits<double>::infinity()) break;
    }
    // Newton's method for position * first = 0, limited to the neighbouring rungs.
    const double end = parameter(cells());
    const double low = closed() ? parameter(nearest) - ladder_.spacing_m
                                : std::max(0.0, parameter(nearest) - ladder_.spacing_m);
    const double high = closed() ? parameter(nearest) + ladder_.spacing_m
                                 : std::min(end, parameter(nearest) + ladder_.spacing_m);
    const auto wrapped = [&](double at) {
        if (!closed()) return at;
        return at < 0.0 ? at + end : (at >= end ? at - end : at);
    };
    double at = parameter(nearest);
    for (int i = 0; i < 4; ++i) {
        const SmoothingSpline::Jet jet = spline_.at(wrapped(at));
        const double slope = jet.first.squaredNorm() + jet.position.dot(jet.second);
        if (!(slope > 0.0)) break;
        at = std::clamp(at - jet.position.dot(jet.first) / slope, low, high);
    }
    at = wrapped(at);
    const std::size_t k = std::min(static_cast<std::size_t>(at / ladder_.spacing_m), cells() - 1);
    return arc_m_[k] + arc_between(parameter(k), at);
}

double CentreLine::usable_length_m(double from_m) const {
    const auto after = std::upper_bound(arc_m_.begin() + 1, arc_m_.end() - 1, from_m);
    const auto first = static_cast<std::size_t>(after - arc_m_.begin()) - 1;
    if (!usable_[first]) return 0.0;
    const std::size_t steps = closed() ? count() - 1 : count() - 1 - first;
    for (std::size_t d = 1; d <= steps; ++d) {
        if (usable_[(first + d) % count()]) continue;
        // Ends at the last rung with a lane.
        const std::size_t last = first + d - 1;
        const double turn_m = last >= count() ? length_m() : 0.0;
        return std::max(0.0, arc_m_[last % count()] + turn_m - from_m);
    }
    return closed() ? length_m() : length_m() - from_m;
}

double CentreLine::width_m(const LaneBoundary& boundary, double place_m, const Point& from,
                           const Point& normal, double max_m) const {
    const auto hit_m = boundary.ray_hit_m(from, normal, place_m, kReach_m);
    if (hit_m && *hit_m <= max_m) return *hit_m;
    const Point& first = boundary.vertices().front();
    const Point& last = boundary.vertices().back();
    const Point& end = (first - from).squaredNorm() < (last - from).squaredNorm() ? first : last;
    return normal.dot(end - from);
}

DrivablePoint CentreLine::at(double arc_m) const {
    const double parameter_m = parameter_at(arc_m);
    const SmoothingSpline::Jet jet = spline_.at(parameter_m);
    const double speed = jet.first.norm();
    const Point normal = Point(-jet.first.y(), jet.first.x()) / speed;
    const auto nearest = static_cast<std::size_t>(std::lround(parameter_m / ladder_.spacing_m)) % count();
    const Rung& rung = ladder_.rungs[nearest];
    const double max_m = 2.0 * (rung.left - rung.right).norm();  // farther is another stretch of the lane
    return {.position = jet.position,
            .heading_rad = turning_angle({1.0, 0.0}, jet.first),
            .curvature_1pm = cross(jet.first, jet.second) / (speed * speed * speed),
            .width_left_m = width_m(ladder_.left, rung.left_m, jet.position, normal, max_m),
            .width_right_m = width_m(ladder_.right, rung.right_m, jet.position, -normal, max_m)};
}

void CentreLine::add_gaps(const LaneBoundary& boundary, bool on_left, double max_gap_m,
                          std::vector<BridgedGap>& gaps) const {
    // Positions of successive rungs increase; on a closed boundary, by its length in all.
    const auto place = [&](std::size_t k) {
        const Rung& rung = ladder_.rungs[k % count()];
        return (on_left ? rung.left_m : rung.right_m) + (k < count() ? 0.0 : boundary.length_m());
    };
    const std::size_t rungs = cells() + 1;
    const auto arc_of = [&](double place_m) {
        std::size_t k = 1;
        while (k + 1 < rungs && place(k) < place_m) ++k;
        const double gap_m = place(k) - place(k - 1);
        const double share = gap_m > 0.0 ? std::clamp((place_m - place(k - 1)) / gap_m, 0.0, 1.0) : 0.0;
        return std::lerp(arc_m_[k - 1], arc_m_[k], share);
    };
    for (std::size_t i = 0; i < boundary.segments(); ++i) {
        double from_m = boundary.segment_start_m(i);
        double to_m = boundary.segment_end_m(i);
        if (to_m - from_m <= max_gap_m) continue;
        double turn_m = 0.0;
        if (closed()) {
            if (from_m < place(0)) from_m += boundary.length_m();
            if (to_m < from_m) to_m += boundary.length_m();
            if (to_m > place(cells())) {
                to_m -= boundary.length_m();
                turn_m = length_m();
            }
        }
        gaps.push_back({on_left, arc_of(from_m), arc_of(to_m) + turn_m});
    }
}

std::vector<BridgedGap> CentreLine::gaps(double max_gap_m) const {
    std::vector<BridgedGap> result;
    add_gaps(ladder_.left, true, max_gap_m, result);
    add_gaps(ladder_.right, false, max_gap_m, result);
    return result;
}

/// The gaps relative to the foot point, restricted to the part of the lane that is kept.
std::vector<BridgedGap> seen_from(const std::vector<BridgedGap>& gaps, double foot_m, double around_m,
                                  const DrivableLane& lane) {
    std::vector<BridgedGap> seen;
    for (BridgedGap gap : gaps) {
        gap.from_s_m -= foot_m;
        gap.to_s_m -= foot_m;
        if (around_m > 0.0 && gap.from_s_m < 0.0 && (lane.closed || gap.to_s_m <= 0.0)) {
            gap.from_s_m += around_m;
            gap.to_s_m += around_m;
        }
        if (!lane.closed) {
            gap.from_s_m = std::max(0.0, gap.from_s_m);
            gap.to_s_m = std::min(lane.length_m, gap.to_s_m);
            if (!(gap.to_s_m > gap.from_s_m)) continue;
        }
        seen.push_back(gap);
    }
    std::ranges::stable_sort(seen, [](const BridgedGap& a, const BridgedGap& b) {
        return a.on_left != b.on_left ? a.on_left : a.from_s_m < b.from_s_m;
    });
    return seen;
}

DrivableLane checked_drivable(const Lane& lane, const Scene& scene, const DrivableOptions& options,
                              const TimeCheck& check_time) {
    validate(options);
    Sides sides = positions(lane, scene);
    const bool left_inferred = infer(sides.left, sides.right, false, lane.closed, options);
    const bool right_inferred = !left_inferred && infer(sides.right, sides.left, true, lane.closed, options);
    if (sides.left.empty() || sides.right.empty()) return {};
    const LaneBoundary left(sides.left, lane.closed);
    const LaneBoundary right(sides.right, lane.closed);
    require_boundary(left, lane.closed, "left");
    require_boundary(right, lane.closed, "right");
    RungLadder ladder = lane_rungs(left, right, kMaxLaneWidth_m, check_time);
    if (ladder.rungs.empty()) return {};
    const CentreLine line(std::move(ladder), options.smoothing_m, check_time);
    check_time();
    const double foot_m = line.foot_m(scene.pose.heading());
    const double usable_m = line.usable_length_m(foot_m);

    DrivableLane result;
    result.left_inferred = left_inferred;
    result.right_inferred = right_inferred;
    result.closed = line.closed() && usable_m >= line.length_m();
    double step_m = options.step_m;
    std::size_t count = 0;
    if (result.closed) {
        count = static_cast<std::size_t>(std::max(3.0, std::round(usable_m / step_m)));
        step_m = usable_m / static_cast<double>(count);
    } else if (usable_m > 0.0) {
        count = static_cast<std::size_t>(std::floor(usable_m / step_m)) + 1;
    }
    result.length_m = usable_m;
    for (std::size_t i = 0; i < count; ++i) {
        const double s_m = static_cast<double>(i) * step_m;
        DrivablePoint point = line.at(foot_m + s_m);
        if (!(std::min(point.width_left_m, point.width_right_m) >= kClearance_m)) {  // past a boundary's end
            result.closed = false;
            result.length_m = i > 0 ? s_m - step_m : 0.0;
            break;
        }
        point.s_m = s_m;
        point.position += scene.pose.position;
        result.points.push_back(point);
    }
    if (!(result.length_m > 0.0)) result.points.clear();
    result.bridged =
        seen_from(line.gaps(options.max_gap_m), foot_m, line.closed() ? line.length_m() : 0.0, result);
    return result;
}

constexpr double kTrustedByRule_m = 10.0;
/// Time that checking a found lane may still take after the limit.
constexpr double kMinTime_ms = 0.5;
/// Of the limit, what is left for checking, so that a search that takes all of its time loses no lane.
constexpr double kCheckShare = 0.04;
constexpr double kMaxCheck_ms = 2.0;

/// No points if the lane is outside of what `drivable` accepts, such as one of more than 20 km. Nothing if
/// the deadline passes.
std::optional<DrivableLane> drivable_or_none(const LaneAnswer& answer, const Scene& scene,
                                             const Deadline& deadline) {
    try {
        return drivable_within(answer.lane, scene, {}, deadline);
    } catch (const InvalidInput&) {
        return DrivableLane{};
    }
}

double trusted_by_rule_m(const DrivableLane& lane) {
    double trusted_m = std::min(lane.length_m, kTrustedByRule_m);
    for (const BridgedGap& gap : lane.bridged) trusted_m = std::min(trusted_m, std::max(0.0, gap.from_s_m));
    return trusted_m;
}

/// Cuts a boundary that is seen alone before its first gap. Returns whether at least three cones are left,
/// and fewer than before.
bool cut_at_first_gap(Lane& lane, const Scene& scene) {
    if (lane.left.empty() == lane.right.empty()) return false;
    std::vector<ConeId>& boundary = lane.left.empty() ? lane.right : lane.left;
    const auto at = [&](ConeId id) { return std::ranges::find(scene.cones, id, &Cone::id)->position; };
    const auto gap = std::ranges::adjacent_find(
        boundary, [&, max_length_m = DrivableOptions{}.max_gap_m](ConeId a, ConeId b) {
            return (at(b) - at(a)).norm() > max_length_m;
        });
    if (gap == boundary.end()) return false;
    boundary.erase(gap + 1, boundary.end());
    return boundary.size() >= 3;
}

class DrivableAnswers final : public LaneDetector {
  public:
    explicit DrivableAnswers(std::unique_ptr<LaneDetector> detector)
        : LaneDetector(detector->doubled_cone_m()), detector_(std::move(detector)) {}
    void reset() override { detector_->reset(); }

  private:
    LaneAnswer search(const Scene& scene, const DetectionLimits& limits) override {
        const Deadline whole(limits.time_limit_ms);
        DetectionLimits of_search = limits;
        of_search.time_limit_ms -= std::clamp(kCheckShare * limits.time_limit_ms, 0.0, kMaxCheck_ms);
        LaneAnswer answer = search_by(*detector_, scene, of_search);
        if (answer.status != LaneStatus::found) return answer;
        const Deadline deadline(std::max(whole.remaining_ms(), kMinTime_ms));
        std::optional<DrivableLane> lane = drivable_or_none(answer, scene, deadline);
        if (lane && lane->points.empty() && cut_at_first_gap(answer.lane, scene))
            lane = drivable_or_none(answer, scene, deadline);
        if (lane && !lane->points.empty()) {
            if (!answer.trusted_m) answer.trusted_m = trusted_by_rule_m(*lane);
            return answer;
        }
        LaneAnswer none;
        none.status = LaneStatus::stopped;
        if (lane) {
            none.stopped_by = answer.stopped_by.value_or(StopReason::iterations);
            none.message = "the lane that was found cannot be driven: it has no centre line from the car on";
        } else {
            none.stopped_by = StopReason::time;
            none.message = "time was over before it was known whether the lane that was found can be driven";
        }
        none.enumeration = std::move(answer.enumeration);
        return none;
    }

    std::unique_ptr<LaneDetector> detector_;
};

}  // namespace

DrivableLane drivable(const Lane& lane, const Scene& scene, const DrivableOptions& options) {
    return checked_drivable(lane, scene, options, TimeCheck());
}

std::optional<DrivableLane> drivable_within(const Lane& lane, const Scene& scene,
                                            const DrivableOptions& options, const Deadline& deadline) {
    try {
        return checked_drivable(lane, scene, options, TimeCheck(deadline));
    } catch (const OutOfTime&) {
        return std::nullopt;
    }
}

DrivableLane drivable(const LaneAnswer& answer, const Scene& scene, const DrivableOptions& options) {
    if (answer.status != LaneStatus::found) return {};
    DrivableLane result = drivable(answer.lane, scene, options);
    if (answer.trusted_m) result.trusted_m = std::min(*answer.trusted_m, result.length_m);
    return result;
}

std::unique_ptr<LaneDetector> answer_drivable_lanes(std::unique_ptr<LaneDetector> detector) {
    return std::make_unique<DrivableAnswers>(std::move(detector));
}

}  // namespace conelane
