#include "conelane/invalid_input.hpp"
#include "detectors/planner/known_gates.hpp"
#include "detectors/planner/lane_stretch.hpp"
#include "detectors/planner/planners.hpp"

#include <utility>

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

/// The course has not been found among the cones yet.
struct Searching {
    std::vector<SeenView> views;
    std::vector<RegistrationFit> contenders;  ///< of this frame
};

/// The course is registered to the map.
struct Tracking {
    Registration registration;
    GateEvidence gates;           ///< of acceleration
    double supported_s = 0.0;     ///< time of the last frame whose cones speak for the registration
    double supported_at_m = 0.0;  ///< where the car was on the route then
    double seen_ahead_m = 0.0;    ///< of the car then
    int settling = 0;             ///< frames until the registration is steady
    int jump_frames = 0;          ///< one after the other that say that the map has jumped
    double surplus = 1.0;         ///< of cones on boundaries over those beside them, mean of the last frames
    double taken = 1.0;           ///< share of the places that have their cone, mean of the last frames
    double line_m = 0.0;          ///< x of the start line in the registration; 0 in skidpad
    double at_m = 0.0;            ///< of the car on the route
    double progress_m = 0.0;      ///< the farthest that it was
    double off_route_m = 0.0;     ///< of the car
    int frames_after_line = 0;    ///< one after the other
    double end_m = 0.0;           ///< of the route
    std::optional<double> closed_x_m = {};  ///< a row of cones across the exit, in coordinates of the route

    /// A place of the map in the coordinates of the route.
    [[nodiscard]] Point on_route(const Point& in_map) const {
        return registration.to_course(in_map) - Point(line_m, 0.0);
    }
};

/// The last line is crossed; the car comes to rest.
struct Finished {
    Tracking tracking;
};

/// All that a run changes.
struct Run {
    std::variant<Searching, Tracking, Finished> state;
    SeenCones seen;
    std::optional<Frame> frame;  ///< the last one
    Pose first_pose;
    bool began = false;  ///< a lane was given
    Plan last;

    /// Null while searching.
    [[nodiscard]] Tracking* tracking() {
        if (auto* const finished = std::get_if<Finished>(&state)) return &finished->tracking;
        return std::get_if<Tracking>(&state);
    }
    [[nodiscard]] bool is_finished() const { return std::holds_alternative<Finished>(state); }
    void finish() {
        if (auto* const tracking = std::get_if<Tracking>(&state)) state = Finished{Tracking(*tracking)};
    }
};

/// A point of the route at a distance from the car, in the map.
DrivablePoint in_map(DrivablePoint point, const Registration& registration, double s_m, double half_width_m) {
    point.s_m = s_m;
    point.position = registration.to_map(point.position);
    point.heading_rad = turn_rad(0.0, point.heading_rad + registration.course.yaw_rad);
    point.width_left_m = point.width_right_m = half_width_m;
    return point;
}

/// A cone that stands on a boundary of the lane.
struct OnBoundary {
    double x_m;
    bool left;
};

bool has_pair(const std::vector<OnBoundary>& beside, double from_x_m, double to_x_m) {
    const auto has = [&](bool left) {
        return std::ranges::any_of(beside, [&](const OnBoundary& cone) {
            return cone.left == left && cone.x_m > from_x_m && cone.x_m < to_x_m;
        });
    };
    return has(true) && has(false);
}

class KnownCoursePlanner final : public Planner {
  public:
    explicit KnownCoursePlanner(const PlannerOptions& options)
        : options_(options),
          detector_(make_detector(options.detector, options.detector_options)),
          known_(known_course(options.mission)) {}

    Plan update(const Frame& frame, const DetectionLimits& limits) override;
    std::optional<DrivableLane> course() const override { return std::nullopt; }
    void reset() override {
        detector_->reset();
        run_ = {};
    }

  private:
    [[nodiscard]] const KnownCourse& shape() const { return known_.course(); }
    void search(Searching& searching, const Frame& frame, const SeenView& view, const Deadline& deadline);
    void track(Tracking& tracking, const Frame& frame, const SeenView& view, const Deadline& deadline) const;
    static bool supports(Tracking& tracking, const RegistrationFit& fit);
    void search_again(Tracking& tracking, const Frame& frame, const SeenView& view,
                      const Deadline& deadline) const;
    void find_lines(Tracking& tracking, const Frame& frame, const SeenView& view) const;
    [[nodiscard]] bool advance(Tracking& tracking, const Pose& pose) const;
    [[nodiscard]] double nearest_on_route(const Point& place, double from_s_m, double to_s_m) const;
    void find_closing_cones(Tracking& tracking) const;
    [[nodiscard]] DrivableLane route_ahead(const Tracking& tracking) const;
    [[nodiscard]] DrivableLane common_route(const Searching& searching, const Pose& car,
                                            double length_m) const;
    void plan_registered(Tracking& tracking, Plan& plan, double time_s);
    void plan_unregistered(const Searching& searching, Plan& plan, const Scene& scene,
                           const Deadline& deadline);

    PlannerOptions options_;
    std::unique_ptr<LaneDetector> detector_;
    KnownRegistration known_;
    Run run_;
};

Plan KnownCoursePlanner::update(const Frame& frame, const DetectionLimits& limits) {
    const Deadline deadline(limits.time_limit_ms);
    const Scene scene = checked_scene(frame, limits);
    if (run_.frame && frame.time_s <= run_.frame->time_s)
        return plan_not_later(run_.last, *run_.frame, frame);
    if (!run_.frame) run_.first_pose = frame.pose;
    run_.seen.observe(frame);
    const SeenView view = view_of(frame);
    if (Tracking* const tracking = run_.tracking()) {
        track(*tracking, frame, view, deadline);
        if (!run_.is_finished()) find_lines(*tracking, frame, view);
        if (advance(*tracking, frame.pose)) run_.finish();
    } else {
        search(std::get<Searching>(run_.state), frame, view, deadline);
    }
    Plan plan;
    if (Tracking* const tracking = run_.tracking()) {
        plan_registered(*tracking, plan, frame.time_s);
        plan.phase = shape().phase(run_.is_finished() ? shape().finish_s_m : tracking->progress_m);
        plan.lap = shape().laps(tracking->progress_m);
    } else {
        plan_unregistered(std::get<Searching>(run_.state), plan, scene, deadline);
        plan.phase = shape().phase(shape().start_x_m);
    }
    run_.frame = frame;
    run_.last = plan;
    return plan;
}

/// Goes on to tracking where one registration alone explains the cones.
void KnownCoursePlanner::search(Searching& searching, const Frame& frame, const SeenView& view,
                                const Deadline& deadline) {
    if (searching.views.size() == kMaxViews) searching.views.erase(searching.views.begin() + 1);
    searching.views.push_back(view);
    searching.contenders.clear();
    if (frame.cones.empty()) return;
    // The car is expected where it has driven to since the first frame, straight on.
    const double driven_m = run_.first_pose.ahead_m(frame.pose.position);
    const Pose expected{{shape().start_x_m + driven_m, 0.0}, 0.0};
    searching.contenders =
        known_.contenders(run_.seen.cones(), searching.views, frame.pose, expected, {}, deadline);
    if (searching.contenders.size() != 1) return;
    const RegistrationFit& fit = searching.contenders.front();
    Tracking tracking{.registration = fit.registration,
                      .gates = GateEvidence(shape().finish_s_m),
                      .supported_s = frame.time_s,
                      .seen_ahead_m = fit.farthest_m,
                      .settling = kSettlingFrames,
                      .end_m = shape().end_s_m};
    find_lines(tracking, frame, view);
    const double x_m = tracking.on_route(frame.pose.position).x();
    tracking.at_m = tracking.progress_m = shape().has_place_along ? std::min(x_m, 0.0) : x_m;
    const bool is_finished = advance(tracking, frame.pose);
    tracking.supported_at_m = tracking.at_m;
    run_.state = std::move(tracking);
    if (is_finished) run_.finish();
}

bool KnownCoursePlanner::supports(Tracking& tracking, const RegistrationFit& fit) {
    // By chance as many cones lie on boundaries as beside them; now and then more in one frame.
    if (fit.matched + fit.beside > 0) {
        const double surplus = static_cast<double>(fit.matched - fit.beside) / (fit.matched + fit.beside);
        tracking.surplus += kSurplusGain * (surplus - tracking.surplus);
    }
    if (fit.places >= kMinPlaces) {
        const double share = static_cast<double>(fit.taken) / fit.places;
        tracking.taken += kSurplusGain * (share - tracking.taken);
    }
    // Cones of the course may be missing, and false ones stand beside it; both at once is too much.
    return fit.matched >= kMinMatched && tracking.off_route_m < kMaxOffRoute_m &&
           tracking.surplus + tracking.taken > kMinSupport;
}

void KnownCoursePlanner::track(Tracking& tracking, const Frame& frame, const SeenView& view,
                               const Deadline& deadline) const {
    if (frame.cones.empty()) return;
    // This frame alone: after a jump of the map, cones of earlier frames are elsewhere.
    SeenCones now;
    now.observe(frame);
    const auto refined = [&](const Stiffness& stiffness) {
        return known_.fit(known_.refine(tracking.registration, now.cones(), frame.pose.position, stiffness),
                          now.cones(), {&view, 1}, frame.pose);
    };
    RegistrationFit fit = refined(tracking.settling > 0 ? kSettling : kSteady);
    const RegistrationFit moved = refined({});
    const bool jumped = moved.score > fit.score + std::max(kJumpGain, kJumpGainShare * fit.score);
    tracking.jump_frames = jumped ? tracking.jump_frames + 1 : 0;
    if (tracking.jump_frames >= kJumpFrames) {
        fit = moved;
        tracking.jump_frames = 0;
        tracking.settling = kSettlingFrames;
    }
    if (!supports(tracking, fit)) {
        if (frame.time_s - tracking.supported_s > kSearchAgain_s)
            search_again(tracking, frame, view, deadline);
        return;
    }
    tracking.settling = std::max(tracking.settling - 1, 0);
    tracking.registration = fit.registration;
    tracking.supported_s = frame.time_s;
    tracking.seen_ahead_m = fit.farthest_m;
}

void KnownCoursePlanner::find_lines(Tracking& tracking, const Frame& frame, const SeenView& view) const {
    if (shape().has_place_along || frame.cones.empty()) return;
    tracking.gates.observe(tracking.registration, frame, view);
    const double moved_m = tracking.gates.start_line_m() - tracking.line_m;
    tracking.line_m += moved_m;
    tracking.at_m -= moved_m;
    tracking.progress_m -= moved_m;
    tracking.supported_at_m -= moved_m;
    if (tracking.closed_x_m) *tracking.closed_x_m -= moved_m;
}

void KnownCoursePlanner::search_again(Tracking& tracking, const Frame& frame, const SeenView& view,
                                      const Deadline& deadline) const {
    const Registration& old = tracking.registration;
    const Pose expected{old.to_course(frame.pose.position), frame.pose.yaw_rad - old.course.yaw_rad};
    SeenCones now;
    now.observe(frame);
    const std::vector<RegistrationFit> found =
        known_.contenders(now.cones(), {&view, 1}, frame.pose, expected,
                          {.ahead_m = 2.4, .left_m = 2.4, .yaw_rad = 0.35}, deadline);
    if (found.size() != 1) return;
    // The next frame has to confirm it: among enough cones some registration fits one frame by chance.
    tracking.registration = found.front().registration;
    tracking.settling = kSettlingFrames;
    tracking.jump_frames = 0;
    tracking.surplus = tracking.taken = 0.5 * kMinSupport;
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

/// Moves the car on along the route. Returns whether it has crossed the last line.
bool KnownCoursePlanner::advance(Tracking& tracking, const Pose& pose) const {
    const Point place = tracking.on_route(pose.position);
    const Point& before = run_.frame ? run_.frame->pose.position : pose.position;
    const double driven_m = std::min((pose.position - before).norm(), kMaxDriven_m);
    tracking.at_m = nearest_on_route(place, tracking.at_m - kWindow_m - kWindowShare * driven_m,
                                     tracking.at_m + kWindow_m + (1.0 + kWindowShare) * driven_m);
    tracking.off_route_m = (shape().at(tracking.at_m).position - place).norm();
    tracking.progress_m = std::max(tracking.progress_m, tracking.at_m);
    const double after_m = tracking.at_m - shape().finish_s_m;
    const bool has_seen_line = shape().has_place_along || tracking.gates.has_seen_finish();
    const double unseen_m = has_seen_line ? 0.0 : kUnseenLine_m;
    tracking.frames_after_line = after_m >= kAfterLine_m + unseen_m ? tracking.frames_after_line + 1 : 0;
    return tracking.frames_after_line >= 2 || after_m >= kSurelyAfterLine_m + unseen_m;
}

void KnownCoursePlanner::find_closing_cones(Tracking& tracking) const {
    if (tracking.at_m < shape().finish_s_m - shape().max_ahead_m) return;
    // In course coordinates x is the route before and after the line, the circles left out.
    const double line_x_m = shape().at(shape().finish_s_m).position.x();
    const double car_x_m = shape().at(tracking.at_m).position.x();
    const double half_m = kKnownHalfWidth_m + tracking.registration.widening_m;
    std::vector<OnBoundary> beside;
    for (const SeenCone& cone : run_.seen.cones()) {
        const Point place = tracking.on_route(cone.position);
        if (cone.sightings < kMinClosingSightings || std::abs(std::abs(place.y()) - half_m) > 0.6) continue;
        beside.push_back({place.x(), place.y() > 0.0});
    }
    const double infinity_m = std::numeric_limits<double>::infinity();
    std::optional<double>& closed_x_m = tracking.closed_x_m;
    if (closed_x_m && has_pair(beside, *closed_x_m + kRow_m, infinity_m)) closed_x_m.reset();
    for (const SeenCone& middle : run_.seen.cones()) {
        const Point place = tracking.on_route(middle.position);
        if (middle.sightings < kMinClosingSightings || std::abs(place.y()) > kMiddle * half_m) continue;
        if (middle.color == ConeColor::blue || middle.color == ConeColor::yellow) continue;
        if (place.x() < line_x_m + kClosedAfter_m || place.x() < car_x_m + kBeforeClosing_m) continue;
        // A row across, and no lane behind it.
        if (!has_pair(beside, place.x() - 0.7, place.x() + 0.7)) continue;
        if (has_pair(beside, place.x() + kRow_m, infinity_m)) continue;
        closed_x_m = std::min(closed_x_m.value_or(infinity_m), place.x());
    }
    tracking.end_m = shape().end_s_m;
    if (closed_x_m) {
        tracking.end_m =
            std::min(tracking.end_m, shape().finish_s_m + *closed_x_m - line_x_m - kBeforeClosing_m);
    }
}

DrivableLane KnownCoursePlanner::route_ahead(const Tracking& tracking) const {
    DrivableLane lane;
    const double step_m = options_.drivable.step_m;
    const double to_go_m = tracking.end_m - tracking.at_m;
    lane.length_m =
        run_.is_finished() ? std::max(to_go_m, 0.0) : std::clamp(to_go_m, 0.0, shape().max_ahead_m);
    // A lane is as wide as the rules say, or as the cones of a straight lane show.
    const double half_m = options_.mission == Mission::acceleration
                              ? kKnownHalfWidth_m + tracking.registration.widening_m
                              : kKnownHalfWidth_m;
    const auto steps = static_cast<std::size_t>(std::floor(lane.length_m / step_m + 1e-9));
    if (steps == 0) return {};
    for (std::size_t i = 0; i <= steps; ++i) {
        const double s_m = static_cast<double>(i) * step_m;
        DrivablePoint point = shape().at(tracking.at_m + s_m);
        point.position += Point(tracking.line_m, 0.0);
        lane.points.push_back(in_map(point, tracking.registration, s_m, half_m));
    }
    return lane;
}

/// The route by the best contender, as far as all of them agree on it.
DrivableLane KnownCoursePlanner::common_route(const Searching& searching, const Pose& car,
                                              double length_m) const {
    DrivableLane lane;
    const std::vector<RegistrationFit>& contenders = searching.contenders;
    if (contenders.empty()) return lane;
    const auto point_at = [&](const Registration& registration, double s_m) {
        return in_map(shape().at(registration.to_course(car.position).x() + s_m), registration, s_m,
                      kKnownHalfWidth_m);
    };
    const double step_m = options_.drivable.step_m;
    for (int i = 0; i * step_m <= length_m; ++i) {
        const DrivablePoint point = point_at(contenders.front().registration, i * step_m);
        const bool all_agree = std::ranges::all_of(contenders, [&](const RegistrationFit& other) {
            if (other.score < kLikely * contenders.front().score) return true;
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

void KnownCoursePlanner::plan_registered(Tracking& tracking, Plan& plan, double time_s) {
    const bool is_finished = run_.is_finished();
    plan.age_s = time_s - tracking.supported_s;
    const bool is_old = plan.age_s > 0.0;
    if (!is_old) tracking.supported_at_m = tracking.at_m;
    if (is_finished || tracking.at_m > shape().finish_s_m - shape().max_ahead_m) find_closing_cones(tracking);
    plan.stop = is_finished;
    const bool is_off = tracking.off_route_m > kMaxOffRoute_m;  // then no cones fit, so this is the reason
    if (plan.age_s > options_.max_age_s || is_off) {
        plan.state = is_finished ? PlanState::finished : PlanState::lost;
        if (!is_finished) plan.reason = is_off ? "the car is off the course" : "too few cones fit the course";
        // Behind the last line there may be no cone: what is left of the lane is straight on.
        if (!is_finished || is_off) return;
    } else {
        plan.state = is_finished ? PlanState::finished : is_old ? PlanState::bridging : PlanState::following;
    }
    plan.lane = route_ahead(tracking);
    const double to_line_m = shape().finish_s_m - tracking.at_m;
    if (to_line_m >= 0.0 && to_line_m <= plan.lane.length_m) plan.stop_line_m = to_line_m;
    const double trusted_m =
        tracking.seen_ahead_m + kSeenBeyond_m - (tracking.at_m - tracking.supported_at_m);
    plan.safe_m = std::clamp(trusted_m, 0.0, plan.lane.length_m);
    if (!plan.lane.points.empty()) plan.lane.trusted_m = plan.safe_m;
    run_.began = true;
}

void KnownCoursePlanner::plan_unregistered(const Searching& searching, Plan& plan, const Scene& scene,
                                           const Deadline& deadline) {
    plan.state = run_.began ? PlanState::lost : PlanState::searching;
    if (run_.began) plan.reason = "the course is not found among the cones";
    const double driven_m = (scene.pose.position - run_.first_pose.position).norm();
    const double left_m = kUnregistered_m - driven_m;
    if (left_m <= 0.0 || scene.cones.size() < kMinDrawnTogether) return;
    DrivableLane lane;
    if (searching.views.size() >= kViewsBeforeCommon) lane = common_route(searching, scene.pose, left_m);
    if (lane.points.empty()) {
        plan.answer = detector_->detect(scene, {.time_limit_ms = std::max(deadline.remaining_ms(), 0.0)});
        lane = drivable(plan.answer, scene, options_.drivable);
        if (lane.points.size() < 2 || lane.closed) return;
        // Only where the lane begins at the car and goes on straight.
        if ((lane.points.front().position - scene.pose.position).norm() > kKnownHalfWidth_m) return;
        const double trusted_m = std::min(left_m, lane.trusted_m.value_or(0.0));
        std::erase_if(lane.points, [&](const DrivablePoint& point) {
            const double turned_rad =
                std::remainder(point.heading_rad - scene.pose.yaw_rad, 2.0 * std::numbers::pi);
            return point.s_m > trusted_m || std::abs(turned_rad) > kMaxStartTurn_rad;
        });
        if (lane.points.size() < 2) return;
        lane.trusted_m = lane.length_m = lane.points.back().s_m;
    }
    plan.state = PlanState::following;
    plan.reason = {};
    plan.safe_m = lane.length_m;
    plan.lane = std::move(lane);
    run_.began = true;
}

}  // namespace

std::unique_ptr<Planner> make_known_course_planner(const PlannerOptions& options) {
    if (options.laps) throw InvalidInput("laps", "is for trackdrive and autocross");
    validate_shared(options);
    return std::make_unique<KnownCoursePlanner>(options);
}

}  // namespace conelane
