#include "detectors/planner/known_course_planner.hpp"

#include "conelane/invalid_input.hpp"
#include "detectors/planner/frame.hpp"
#include "detectors/planner/known_course.hpp"
#include "detectors/planner/known_gates.hpp"
#include "detectors/planner/known_registration.hpp"
#include "detectors/planner/seen_cones.hpp"
#include "model/deadline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace conelane {
namespace {

// Registration from frame to frame.
/// The map moves little from frame to frame, and a boundary on a circle does not determine its rotation: so
/// the cones of one frame have little weight.
constexpr Stiffness kSteady{.place_m = 0.04, .yaw_rad = 0.004, .widening_m = 0.02};
constexpr Stiffness kSettling{.place_m = 0.15, .yaw_rad = 0.015, .widening_m = 0.05};
constexpr int kSettlingFrames = 15;  ///< after a search
constexpr double kJumpGain = 2.0;    ///< gain of the score by a large move: the map has jumped
constexpr double kJumpGainShare = 0.15;
constexpr int kJumpFrames = 2;  ///< in so many frames in a row
constexpr int kMinMatched = 3;
constexpr double kSurplusGain = 0.3;  ///< weight of one frame
constexpr int kMinPlaces = 3;
constexpr double kMinSupport = 0.8;     ///< least sum of surplus and share of places with a cone
constexpr double kMaxOffRoute_m = 4.0;  ///< a car farther away does not drive this course
constexpr double kSearchAgain_s = 0.3;  ///< after so long without support, search again
constexpr std::size_t kMaxViews = 8;    ///< remembered while searching
constexpr std::size_t kMinDrawnTogether = 6;

// Progress along the route.
constexpr double kWindow_m = 2.0;
constexpr double kWindowShare = 0.4;  ///< of the distance driven since the last frame
constexpr double kProgressStep_m = 0.25;
constexpr double kMaxDriven_m = 30.0;  ///< between two frames; more is a jump of the pose

// The last line: said a little after it, never before.
constexpr double kAfterLine_m = 1.0;  ///< in two frames one after the other
constexpr double kSurelyAfterLine_m = 2.0;
constexpr double kUnseenLine_m = 2.5;  ///< farther where no gate has shown the line

// Where cones close the exit.
constexpr double kClosedAfter_m = 10.0;  ///< the line at the earliest
constexpr double kBeforeClosing_m = 2.0;
constexpr int kMinClosingSightings = 3;
constexpr double kRow_m = 1.5;   ///< behind a row: what stands there is not of it
constexpr double kMiddle = 0.6;  ///< of the half width: a cone nearer to the middle stands in the way

// The lane of the detector, before the registration.
constexpr double kUnregistered_m = 10.0;  ///< may be driven by it: both missions begin straight
constexpr double kMaxStartTurn_rad = 0.6;

// Or what all likely registrations have in common.
constexpr std::size_t kViewsBeforeCommon = 5;
constexpr double kAgreed_m = 0.7;
constexpr double kLikely = 0.92;  ///< of the best score
constexpr double kMinCommon_m = 2.5;

constexpr double kSeenBeyond_m = 5.0;  ///< of the farthest matched cone, a lane is trusted

void validate(const PlannerOptions& options) {
    if (options.laps) throw InvalidInput("laps", "is for trackdrive and autocross");
    validate_shared(options);
}

class KnownCoursePlanner final : public Planner {
  public:
    explicit KnownCoursePlanner(const PlannerOptions& options)
        : options_(options),
          detector_(make_detector(options.detector, options.detector_options)),
          known_(known_course(options.mission)),
          gates_(known_.course().finish_s_m) {}

    Plan update(const Frame& frame, const DetectionLimits& limits) override;
    std::optional<DrivableLane> course() const override { return std::nullopt; }
    void reset() override;

  private:
    [[nodiscard]] const KnownCourse& shape() const { return known_.course(); }
    void search(const Frame& frame, const SeenView& view, const Deadline& deadline);
    void track(const Frame& frame, const SeenView& view, const Deadline& deadline);
    bool supports(const RegistrationFit& fit);
    void search_again(const Frame& frame, const SeenView& view, const Deadline& deadline);
    void find_lines(const Frame& frame, const SeenView& view);
    void accept(const RegistrationFit& fit, const Frame& frame);
    void advance(const Pose& pose);
    /// A place of the map in the coordinates of the route.
    [[nodiscard]] Point on_route(const Point& in_map) const {
        return registration_->to_course(in_map) - Point(line_m_, 0.0);
    }
    [[nodiscard]] double nearest_on_route(const Point& place, double from_s_m, double to_s_m) const;
    void find_closing_cones();
    [[nodiscard]] DrivableLane route_ahead() const;
    [[nodiscard]] DrivableLane common_route(const Pose& car, double length_m) const;
    void plan_registered(Plan& plan, const Frame& frame);
    void plan_unregistered(Plan& plan, const Scene& scene, const Deadline& deadline);

    PlannerOptions options_;
    std::unique_ptr<LaneDetector> detector_;
    KnownRegistration known_;
    GateEvidence gates_;  ///< of acceleration

    SeenCones seen_;
    std::vector<SeenView> views_;              ///< while searching
    std::vector<RegistrationFit> contenders_;  ///< of this frame, while searching
    int settling_ = 0;                         ///< frames until the registration is steady
    double surplus_ = 1.0;  ///< of cones on boundaries over those beside them, mean of the last frames
    double taken_ = 1.0;    ///< share of the places that have their cone, mean of the last frames
    int jump_frames_ = 0;   ///< one after the other that say that the map has jumped
    std::optional<double> time_s_;
    Pose first_pose_;
    Pose last_pose_;
    std::size_t last_count_ = 0;  ///< of cones
    std::optional<Registration> registration_;
    double supported_s_ = 0.0;     ///< time of the last frame whose cones speak for the registration
    double supported_at_m_ = 0.0;  ///< where the car was on the route then
    double seen_ahead_m_ = 0.0;    ///< of the car then
    double line_m_ = 0.0;          ///< x of the start line in the registration; 0 in skidpad
    double at_m_ = 0.0;            ///< of the car on the route
    double progress_m_ = 0.0;      ///< the farthest that it was
    double off_route_m_ = 0.0;     ///< of the car
    int frames_after_line_ = 0;
    bool finished_ = false;
    double end_m_ = 0.0;                ///< of the route
    std::optional<double> closed_x_m_;  ///< a row of cones across the exit, in coordinates of the route
    bool began_ = false;                ///< a lane was given
    Plan last_;
};

void KnownCoursePlanner::reset() {
    detector_->reset();
    seen_.clear();
    views_.clear();
    contenders_.clear();
    settling_ = 0;
    jump_frames_ = 0;
    time_s_.reset();
    registration_.reset();
    gates_.clear();
    line_m_ = 0.0;
    frames_after_line_ = 0;
    finished_ = false;
    closed_x_m_.reset();
    began_ = false;
    last_ = {};
}

Plan KnownCoursePlanner::update(const Frame& frame, const DetectionLimits& limits) {
    const Deadline deadline(limits.time_limit_ms);
    const Scene scene = checked_scene(frame, limits);
    if (time_s_ && frame.time_s <= *time_s_) {
        Plan plan = last_;
        // The same frame again has the same answer; another one says nothing new.
        const bool is_same = frame.time_s == *time_s_ && frame.pose.position == last_pose_.position &&
                             frame.cones.size() == last_count_;
        if (!is_same && plan.state == PlanState::following) plan.state = PlanState::bridging;
        return plan;
    }
    if (!time_s_) first_pose_ = last_pose_ = frame.pose;
    time_s_ = frame.time_s;
    seen_.observe(frame);
    const SeenView view = view_of(frame);
    Plan plan;
    if (registration_) {
        track(frame, view, deadline);
        find_lines(frame, view);
        advance(frame.pose);
    } else {
        search(frame, view, deadline);
    }
    if (registration_) {
        plan_registered(plan, frame);
    } else {
        plan_unregistered(plan, scene, deadline);
    }
    plan.phase = registration_ ? shape().phase(finished_ ? shape().finish_s_m : progress_m_)
                               : shape().phase(shape().start_x_m);
    plan.lap = registration_ ? shape().laps(progress_m_) : 0;
    last_pose_ = frame.pose;
    last_count_ = frame.cones.size();
    last_ = plan;
    return plan;
}

void KnownCoursePlanner::search(const Frame& frame, const SeenView& view, const Deadline& deadline) {
    if (views_.size() == kMaxViews) views_.erase(views_.begin() + 1);
    views_.push_back(view);
    contenders_.clear();
    if (frame.cones.empty()) return;
    // The car is expected where it has driven to since the first frame, straight on.
    const double driven_m = first_pose_.ahead_m(frame.pose.position);
    Pose expected{{shape().start_x_m + driven_m, 0.0}, 0.0};
    contenders_ = known_.contenders(seen_.cones(), views_, frame.pose, expected, {}, deadline);
    if (contenders_.size() == 1) {
        end_m_ = shape().end_s_m;
        accept(contenders_.front(), frame);
        find_lines(frame, view);
        const double x_m = registration_->to_course(frame.pose.position).x() - line_m_;
        at_m_ = progress_m_ = shape().has_place_along ? std::min(x_m, 0.0) : x_m;
        advance(frame.pose);
        supported_at_m_ = at_m_;
        views_.clear();
        contenders_.clear();
    }
}

void KnownCoursePlanner::accept(const RegistrationFit& fit, const Frame& frame) {
    registration_ = fit.registration;
    supported_s_ = frame.time_s;
    seen_ahead_m_ = fit.farthest_m;
    settling_ = kSettlingFrames;
    jump_frames_ = 0;
    surplus_ = 1.0;
    taken_ = 1.0;
}

bool KnownCoursePlanner::supports(const RegistrationFit& fit) {
    // By chance as many cones lie on boundaries as beside them; now and then more in one frame.
    if (fit.matched + fit.beside > 0) {
        const double surplus = static_cast<double>(fit.matched - fit.beside) / (fit.matched + fit.beside);
        surplus_ += kSurplusGain * (surplus - surplus_);
    }
    if (fit.places >= kMinPlaces) {
        const double share = static_cast<double>(fit.taken) / fit.places;
        taken_ += kSurplusGain * (share - taken_);
    }
    // Cones of the course may be missing, and false ones stand beside it; both at once is too much.
    return fit.matched >= kMinMatched && off_route_m_ < kMaxOffRoute_m && surplus_ + taken_ > kMinSupport;
}

void KnownCoursePlanner::track(const Frame& frame, const SeenView& view, const Deadline& deadline) {
    if (frame.cones.empty()) return;
    // This frame alone: after a jump of the map, cones of earlier frames are elsewhere.
    SeenCones now;
    now.observe(frame);
    const auto refined = [&](const Stiffness& stiffness) {
        return known_.fit(known_.refine(*registration_, now.cones(), frame.pose.position, stiffness),
                          now.cones(), {&view, 1}, frame.pose);
    };
    RegistrationFit fit = refined(settling_ > 0 ? kSettling : kSteady);
    const RegistrationFit moved = refined({});
    const bool jumped = moved.score > fit.score + std::max(kJumpGain, kJumpGainShare * fit.score);
    jump_frames_ = jumped ? jump_frames_ + 1 : 0;
    if (jump_frames_ >= kJumpFrames) {
        fit = moved;
        jump_frames_ = 0;
        settling_ = kSettlingFrames;
    }
    if (!supports(fit)) {
        if (frame.time_s - supported_s_ > kSearchAgain_s) search_again(frame, view, deadline);
        return;
    }
    settling_ = std::max(settling_ - 1, 0);
    registration_ = fit.registration;
    supported_s_ = frame.time_s;
    seen_ahead_m_ = fit.farthest_m;
}

void KnownCoursePlanner::find_lines(const Frame& frame, const SeenView& view) {
    if (shape().has_place_along || finished_ || frame.cones.empty()) return;
    gates_.observe(*registration_, frame, view);
    const double moved_m = gates_.start_line_m() - line_m_;
    line_m_ += moved_m;
    at_m_ -= moved_m;
    progress_m_ -= moved_m;
    supported_at_m_ -= moved_m;
    if (closed_x_m_) *closed_x_m_ -= moved_m;
}

void KnownCoursePlanner::search_again(const Frame& frame, const SeenView& view, const Deadline& deadline) {
    const Registration& old = *registration_;
    const Pose expected{old.to_course(frame.pose.position), frame.pose.yaw_rad - old.course.yaw_rad};
    SeenCones now;
    now.observe(frame);
    if (const auto found = known_.search(now.cones(), {&view, 1}, frame.pose, expected,
                                         {.ahead_m = 2.4, .left_m = 2.4, .yaw_rad = 0.35}, deadline)) {
        // The next frame has to confirm it: among enough cones some registration fits one frame by chance.
        registration_ = found->registration;
        settling_ = kSettlingFrames;
        jump_frames_ = 0;
        surplus_ = taken_ = 0.5 * kMinSupport;
    }
}

double KnownCoursePlanner::nearest_on_route(const Point& place, double from_s_m, double to_s_m) const {
    double nearest_m = from_s_m;
    double distance_m2 = std::numeric_limits<double>::infinity();
    for (double s_m = from_s_m; s_m <= to_s_m; s_m += kProgressStep_m) {
        const double m2 = (shape().at(s_m).position - place).squaredNorm();
        if (m2 >= distance_m2) continue;
        distance_m2 = m2;
        nearest_m = s_m;
    }
    // Along the tangent to the foot point: the rest of a step.
    const DrivablePoint point = shape().at(nearest_m);
    const Point heading(std::cos(point.heading_rad), std::sin(point.heading_rad));
    const double rest_m = heading.dot(place - point.position);
    return nearest_m + std::clamp(rest_m, -kProgressStep_m, kProgressStep_m);
}

void KnownCoursePlanner::advance(const Pose& pose) {
    const Point place = on_route(pose.position);
    const double driven_m = std::min((pose.position - last_pose_.position).norm(), kMaxDriven_m);
    at_m_ = nearest_on_route(place, at_m_ - kWindow_m - kWindowShare * driven_m,
                             at_m_ + kWindow_m + (1.0 + kWindowShare) * driven_m);
    off_route_m_ = (shape().at(at_m_).position - place).norm();
    progress_m_ = std::max(progress_m_, at_m_);
    const double after_m = at_m_ - shape().finish_s_m;
    const bool has_seen_line = shape().has_place_along || gates_.has_seen_finish();
    const double unseen_m = has_seen_line ? 0.0 : kUnseenLine_m;
    frames_after_line_ = after_m >= kAfterLine_m + unseen_m ? frames_after_line_ + 1 : 0;
    if (frames_after_line_ >= 2 || after_m >= kSurelyAfterLine_m + unseen_m) finished_ = true;
}

void KnownCoursePlanner::find_closing_cones() {
    if (at_m_ < shape().finish_s_m - shape().max_ahead_m) return;
    // In course coordinates x is the route before and after the line, the circles left out.
    const double line_x_m = shape().at(shape().finish_s_m).position.x();
    const double car_x_m = shape().at(at_m_).position.x();
    const double half_m = kKnownHalfWidth_m + registration_->widening_m;
    struct OnBoundary {
        double x_m;
        bool left;
    };
    std::vector<OnBoundary> beside;
    for (const SeenCone& cone : seen_.cones()) {
        const Point place = on_route(cone.position);
        if (cone.sightings < kMinClosingSightings || std::abs(std::abs(place.y()) - half_m) > 0.6) continue;
        beside.push_back({place.x(), place.y() > 0.0});
    }
    const auto has_pair = [&](double from_x_m, double to_x_m) {
        const auto has = [&](bool left) {
            return std::ranges::any_of(beside, [&](const OnBoundary& cone) {
                return cone.left == left && cone.x_m > from_x_m && cone.x_m < to_x_m;
            });
        };
        return has(true) && has(false);
    };
    const double infinity_m = std::numeric_limits<double>::infinity();
    if (closed_x_m_ && has_pair(*closed_x_m_ + kRow_m, infinity_m)) closed_x_m_.reset();
    for (const SeenCone& middle : seen_.cones()) {
        const Point place = on_route(middle.position);
        if (middle.sightings < kMinClosingSightings || std::abs(place.y()) > kMiddle * half_m) continue;
        if (middle.color == ConeColor::blue || middle.color == ConeColor::yellow) continue;
        if (place.x() < line_x_m + kClosedAfter_m || place.x() < car_x_m + kBeforeClosing_m) continue;
        // A row across, and no lane behind it.
        if (!has_pair(place.x() - 0.7, place.x() + 0.7)) continue;
        if (has_pair(place.x() + kRow_m, infinity_m)) continue;
        closed_x_m_ = std::min(closed_x_m_.value_or(infinity_m), place.x());
    }
    end_m_ = shape().end_s_m;
    if (closed_x_m_) {
        end_m_ = std::min(end_m_, shape().finish_s_m + *closed_x_m_ - line_x_m - kBeforeClosing_m);
    }
}

DrivableLane KnownCoursePlanner::route_ahead() const {
    DrivableLane lane;
    const double step_m = options_.drivable.step_m;
    const double to_go_m = end_m_ - at_m_;
    lane.length_m = finished_ ? std::max(to_go_m, 0.0) : std::clamp(to_go_m, 0.0, shape().max_ahead_m);
    // A lane is as wide as the rules say, or as the cones of a straight lane show.
    const double half_m = options_.mission == Mission::acceleration
                              ? kKnownHalfWidth_m + registration_->widening_m
                              : kKnownHalfWidth_m;
    const auto steps = static_cast<std::size_t>(std::floor(lane.length_m / step_m + 1e-9));
    if (steps == 0) return {};
    for (std::size_t i = 0; i <= steps; ++i) {
        const double s_m = static_cast<double>(i) * step_m;
        DrivablePoint point = shape().at(at_m_ + s_m);
        point.s_m = s_m;
        point.position = registration_->to_map(point.position + Point(line_m_, 0.0));
        point.heading_rad =
            std::remainder(point.heading_rad + registration_->course.yaw_rad, 2.0 * std::numbers::pi);
        if (point.heading_rad <= -std::numbers::pi) point.heading_rad = std::numbers::pi;
        point.width_left_m = point.width_right_m = half_m;
        lane.points.push_back(point);
    }
    return lane;
}

/// The route by the best contender, as far as all of them agree on it.
DrivableLane KnownCoursePlanner::common_route(const Pose& car, double length_m) const {
    DrivableLane lane;
    if (contenders_.empty()) return lane;
    const auto point_at = [&](const Registration& registration, double s_m) {
        DrivablePoint point = shape().at(registration.to_course(car.position).x() + s_m);
        point.s_m = s_m;
        point.position = registration.to_map(point.position);
        point.heading_rad =
            std::remainder(point.heading_rad + registration.course.yaw_rad, 2.0 * std::numbers::pi);
        if (point.heading_rad <= -std::numbers::pi) point.heading_rad = std::numbers::pi;
        point.width_left_m = point.width_right_m = kKnownHalfWidth_m;
        return point;
    };
    const double step_m = options_.drivable.step_m;
    for (int i = 0; i * step_m <= length_m; ++i) {
        const DrivablePoint point = point_at(contenders_.front().registration, i * step_m);
        const bool all_agree = std::ranges::all_of(contenders_, [&](const RegistrationFit& other) {
            if (other.score < kLikely * contenders_.front().score) return true;
            return (point_at(other.registration, i * step_m).position - point.position).norm() < kAgreed_m;
        });
        if (!all_agree) break;
        lane.points.push_back(point);
        lane.length_m = point.s_m;
    }
    if (lane.length_m < kMinCommon_m) return {};
    lane.trusted_m = lane.length_m;
    return lane;
}

void KnownCoursePlanner::plan_registered(Plan& plan, const Frame& frame) {
    plan.age_s = frame.time_s - supported_s_;
    const bool old = plan.age_s > 0.0;
    if (!old) supported_at_m_ = at_m_;
    if (finished_ || at_m_ > shape().finish_s_m - shape().max_ahead_m) find_closing_cones();
    plan.stop = finished_;
    if (plan.age_s > options_.max_age_s || off_route_m_ > kMaxOffRoute_m) {
        plan.state = finished_ ? PlanState::finished : PlanState::lost;
        // Behind the last line there may be no cone: what is left of the lane is straight on.
        if (!finished_ || off_route_m_ > kMaxOffRoute_m) return;
    } else {
        plan.state = finished_ ? PlanState::finished : old ? PlanState::bridging : PlanState::following;
    }
    plan.lane = route_ahead();
    const double trusted_m = seen_ahead_m_ + kSeenBeyond_m - (at_m_ - supported_at_m_);
    plan.safe_m = std::clamp(trusted_m, 0.0, plan.lane.length_m);
    if (!plan.lane.points.empty()) plan.lane.trusted_m = plan.safe_m;
    began_ = true;
}

void KnownCoursePlanner::plan_unregistered(Plan& plan, const Scene& scene, const Deadline& deadline) {
    plan.state = began_ ? PlanState::lost : PlanState::searching;
    const double driven_m = (scene.pose.position - first_pose_.position).norm();
    const double left_m = kUnregistered_m - driven_m;
    if (left_m <= 0.0 || scene.cones.size() < kMinDrawnTogether) return;
    if (views_.size() >= kViewsBeforeCommon) {
        plan.lane = common_route(scene.pose, left_m);
        if (!plan.lane.points.empty()) {
            plan.state = PlanState::following;
            plan.safe_m = plan.lane.length_m;
            began_ = true;
            return;
        }
    }
    plan.answer = detector_->detect(scene, {.time_limit_ms = std::max(deadline.remaining_ms(), 0.0)});
    DrivableLane lane = drivable(plan.answer, scene, options_.drivable);
    if (lane.points.size() < 2 || lane.closed) return;
    const DrivablePoint& first = lane.points.front();
    // Only where the lane begins at the car and goes on straight.
    if ((first.position - scene.pose.position).norm() > kKnownHalfWidth_m) return;
    const double trusted_m = std::min(left_m, lane.trusted_m.value_or(0.0));
    std::erase_if(lane.points, [&](const DrivablePoint& point) {
        return point.s_m > trusted_m || std::abs(std::remainder(point.heading_rad - scene.pose.yaw_rad,
                                                                2.0 * std::numbers::pi)) > kMaxStartTurn_rad;
    });
    if (lane.points.size() < 2) return;
    lane.length_m = lane.points.back().s_m;
    lane.trusted_m = lane.length_m;
    plan.state = PlanState::following;
    plan.safe_m = lane.length_m;
    plan.lane = std::move(lane);
    began_ = true;
}

}  // namespace

std::unique_ptr<Planner> make_known_course_planner(const PlannerOptions& options) {
    validate(options);
    return std::make_unique<KnownCoursePlanner>(options);
}

}  // namespace conelane
