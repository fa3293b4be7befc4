#include "conelane/invalid_input.hpp"
#include "detectors/planner/boundary_memory.hpp"
#include "detectors/planner/course_memory.hpp"
#include "detectors/planner/lane_choice.hpp"
#include "detectors/planner/lane_stretch.hpp"
#include "detectors/planner/lap_counter.hpp"
#include "detectors/planner/planners.hpp"

namespace conelane {
namespace {

void validate(const PlannerOptions& options) {
    if (options.laps && *options.laps < 1) throw InvalidInput("laps", "must be at least 1");
    validate_shared(options);
}

constexpr LaneChoiceSettings kChoice;
constexpr CourseSettings kCourse;

/// Where two lanes from the car on part; infinite if one of them ends before.
double parted_m(const DrivableLane& lane, const DrivableLane& other) {
    constexpr double kEnd_m = 1.5;
    const double shared_m = common_m(lane, other, kChoice.jump_m, kChoice.near_m);
    return shared_m >= std::min(lane.length_m, other.length_m) - kEnd_m
               ? std::numeric_limits<double>::infinity()
               : shared_m;
}

/// How far a lane that the detector trusts leaves another one uncontested.
double contested_m(const DrivableLane& seen, const DrivableLane& lane) {
    const double shared_m = parted_m(seen, lane);
    return seen.trusted_m.value_or(0.0) > shared_m ? shared_m : std::numeric_limits<double>::infinity();
}

/// Whether a lane takes a cone of a boundary, the only one of `alone`, for one of the other side.
bool mistakes_side(const Lane& lane, const Lane& alone) {
    const auto is_in = [](const std::vector<ConeId>& side) {
        return [&side](ConeId id) { return std::ranges::find(side, id) != side.end(); };
    };
    return std::ranges::any_of(alone.left, is_in(lane.right)) ||
           std::ranges::any_of(alone.right, is_in(lane.left));
}

/// All that a run changes.
struct Run {
    Run(const PlannerOptions& options, int laps)
        : path(kChoice, options.drivable.step_m, options.max_age_s),
          choice(kChoice),
          counter(kCourse, laps),
          course(kCourse, options.drivable.step_m) {}

    ConeMemory cones;
    BoundaryMemory boundaries;
    PathMemory path;
    LaneChoice choice;
    LapCounter counter;
    CourseMemory course;
    std::optional<Frame> frame;  ///< the last one
    Plan last;
    bool started = false;  ///< a lane was driven
};

class LapPlanner final : public Planner {
  public:
    LapPlanner(const PlannerOptions& options, std::unique_ptr<LaneDetector> detector)
        : options_(options),
          laps_(options.laps.value_or(options.mission == Mission::autocross ? 1 : 10)),
          detector_(std::move(detector)),
          run_(options_, laps_) {}

    Plan update(const Frame& frame, const DetectionLimits& limits) override;
    std::optional<DrivableLane> course() const override { return run_.course.course(); }
    void reset() override {
        detector_->reset();
        run_ = Run(options_, laps_);
    }

  private:
    /// What a frame says of the path; nothing: no lane.
    struct Choice {
        std::optional<DrivableLane> seen;   ///< the detector's lane, to be driven or not
        std::optional<DrivableLane> fresh;  ///< of this frame
        bool is_answer = false;             ///< `fresh` is `seen`, not a candidate
    };

    [[nodiscard]] std::optional<DrivableLane> fresh_lane(const LaneAnswer& answer, const Scene& scene,
                                                         const DrivableLane& left) const;
    [[nodiscard]] Choice seen_lane(const LaneAnswer& answer, const Scene& scene, const DrivableLane& left);
    [[nodiscard]] Choice chosen_lane(const LaneAnswer& answer, const Scene& scene, const DrivableLane& left);
    [[nodiscard]] bool follow_course(const Choice& choice, const DrivableLane& left, Plan& plan,
                                     double& until_m);
    [[nodiscard]] LaneAnswer named_as_given(LaneAnswer answer) const;
    void choose_path(const Choice& choice, const DrivableLane& left, Plan& plan, double until_m);
    void keep_path(Plan& plan);
    void lead_out(Plan& plan) const;
    void finish(Plan& plan) const;

    PlannerOptions options_;
    int laps_;
    std::unique_ptr<LaneDetector> detector_;
    Run run_;
};

Plan LapPlanner::update(const Frame& frame, const DetectionLimits& limits) {
    static_cast<void>(checked_scene(frame, limits));  // throws if the frame or a limit is invalid
    if (run_.frame && frame.time_s <= run_.frame->time_s)
        return plan_not_later(run_.last, *run_.frame, frame);
    run_.frame = frame;
    if (const auto shift = run_.cones.observe(frame)) {
        run_.path.move_along(*shift);
        run_.choice.move_along(*shift);
        run_.counter.move_along(*shift);
        run_.course.move_along(*shift);
    }
    run_.course.observe(frame, run_.cones);
    const Scene scene = run_.cones.scene(frame.pose);
    Plan plan;
    DetectionLimits with_candidates = limits;
    with_candidates.keep_candidates = true;
    plan.answer = detector_->detect(scene, with_candidates);
    const DrivableLane left = run_.path.left(frame.pose, frame.time_s);
    const Choice choice = seen_lane(plan.answer, scene, left);
    double until_m = std::numeric_limits<double>::infinity();
    if (!follow_course(choice, left, plan, until_m)) choose_path(choice, left, plan, until_m);
    if (plan.answer.enumeration && !limits.keep_candidates) plan.answer.enumeration->candidates.clear();
    plan.answer = named_as_given(std::move(plan.answer));
    run_.course.record(plan.lane, run_.cones);
    run_.counter.observe(frame.pose, plan.lane, run_.cones);
    lead_out(plan);
    plan.stop_line_m = run_.counter.to_stop_line_m(plan.lane);
    plan.lap = std::min(run_.counter.laps(), laps_);
    if (run_.counter.laps() >= laps_) finish(plan);
    run_.last = plan;
    return plan;
}

/// The path is the course of the lap before while the cones of this frame confirm it and the frame's own lane
/// is not trusted farther. Returns false, with a reason, where it is not. `until_m` becomes the place where
/// the frame contradicts the course, if it does.
bool LapPlanner::follow_course(const Choice& choice, const DrivableLane& left, Plan& plan, double& until_m) {
    if (!run_.course.closed()) return false;
    const DrivableLane course = run_.course.ahead(run_.frame->pose, kChoice.known_ahead_m);
    LaneTrust trust = run_.course.trust(course, run_.cones);
    if (choice.seen && !course.points.empty()) {
        const double contested = contested_m(*choice.seen, course);
        if (contested < trust.length_m) trust = {contested, "a trusted lane leaves the course"};
    }
    if (trust.length_m > 0.0 && !left.points.empty() && !run_.choice.agrees(course, left))
        trust = {0.0, "the car is not on the course"};
    plan.reason = trust.reason;
    if (trust.length_m <= 0.0 || !run_.course.is_confirmed()) return false;
    if (!trust.reason.empty()) until_m = trust.length_m;
    if (choice.fresh && choice.fresh->trusted_m.value_or(0.0) > trust.length_m) return false;
    // What this frame shows for sure is newer than the course. Where the two do not meet, each counts half.
    const double step_m = options_.drivable.step_m;
    DrivableLane shown;
    if (choice.fresh) shown = stretch(*choice.fresh, 0.0, choice.fresh->trusted_m.value_or(0.0), step_m);
    DrivableLane lane = extended(shown, course, step_m);
    if (lane.length_m < course.length_m - kChoice.near_m) lane = steadied(course, shown, step_m);
    plan.lane = steadied(lane, left, step_m);
    if (choice.fresh) run_.course.lean_on(*choice.fresh);
    plan.lane.trusted_m = std::min(run_.path.steady_trust_m(trust.length_m, until_m), plan.lane.length_m);
    keep_path(plan);
    return true;
}

/// The path of this frame.
void LapPlanner::keep_path(Plan& plan) {
    run_.path.remember(plan.lane, run_.frame->time_s);
    plan.state = PlanState::following;
    plan.safe_m = *plan.lane.trusted_m;
    run_.started = true;
}

/// `left`: the rest of the lane driven so far, which is trusted up to `until_m` at most.
void LapPlanner::choose_path(const Choice& choice, const DrivableLane& left, Plan& plan, double until_m) {
    const std::optional<DrivableLane>& seen = choice.seen;
    const std::optional<DrivableLane>& fresh = choice.fresh;
    if (fresh) {
        plan.lane = steadied(*fresh, left, options_.drivable.step_m);
        until_m = std::min(
            {until_m, left.points.empty() ? 0.0 : parted_m(plan.lane, left), contested_m(*seen, plan.lane)});
        const double kept_m = run_.path.steady_trust_m(plan.lane.trusted_m.value_or(0.0), until_m);
        // An uncertain lane must not make the planner forget what it knew, because the next frame could then
        // lead anywhere.
        if (plan.lane.length_m < std::max(kChoice.short_m, kept_m)) {
            plan.lane = extended(plan.lane, left, options_.drivable.step_m);
        }
        plan.lane.trusted_m = std::min(kept_m, plan.lane.length_m);
        keep_path(plan);
    } else if (!left.points.empty()) {
        plan.lane = left;
        if (seen) until_m = std::min(until_m, contested_m(*seen, plan.lane));
        plan.lane.trusted_m = plan.safe_m = std::min(plan.lane.trusted_m.value_or(0.0), until_m);
        plan.state = PlanState::bridging;
        plan.age_s = run_.frame->time_s - run_.path.time_s();
    } else {
        plan.state = run_.started ? PlanState::lost : PlanState::searching;
        if (run_.started) plan.reason = run_.path.why_none();
    }
}

std::optional<DrivableLane> LapPlanner::fresh_lane(const LaneAnswer& answer, const Scene& scene,
                                                   const DrivableLane& left) const {
    // A lane of one boundary is as wide as the lane driven so far.
    DrivableOptions options = options_.drivable;
    if (!left.points.empty()) {
        const DrivablePoint& here = left.points.front();
        const double width_m = here.width_left_m + here.width_right_m;
        options.default_width_m = std::clamp(width_m, kChoice.narrowest_m, kMaxLaneWidth_m);
    }
    DrivableLane lane = drivable(answer, scene, options);
    const double step_m = options.step_m;
    if (lane.closed) {
        const auto trusted_m = lane.trusted_m;
        lane = stretch(lane, 0.0, lane.length_m, step_m);
        lane.trusted_m = trusted_m;
    }
    return begun_at_car(lane, scene.pose, left.points.empty() ? nullptr : &left, step_m);
}

/// The lane of a frame, which teaches the sides of cones where it is trusted. A lane of the detector that is
/// not trusted gives way to a known boundary that is in view alone.
LapPlanner::Choice LapPlanner::seen_lane(const LaneAnswer& answer, const Scene& scene,
                                         const DrivableLane& left) {
    run_.boundaries.pass(scene.pose, run_.cones);
    const bool is_two_sided = !answer.lane.left.empty() && !answer.lane.right.empty();
    const double trusted_m = is_two_sided ? answer.trusted_m.value_or(0.0) : 0.0;
    std::optional<Lane> alone;
    if (trusted_m <= 0.0) alone = run_.boundaries.alone(scene, run_.cones);
    if (alone && (!is_two_sided || mistakes_side(answer.lane, *alone))) {
        LaneAnswer outer;
        outer.status = LaneStatus::found;
        outer.lane = *alone;
        outer.trusted_m = kChoice.alone_m;
        Choice choice = chosen_lane(outer, scene, left);
        if (choice.is_answer) run_.boundaries.learn(outer.lane, *choice.fresh, kChoice.passing_m, run_.cones);
        if (choice.seen) return choice;
    }
    Choice choice = chosen_lane(answer, scene, left);
    const double sure_m = answer.confidence.value_or(0.0) > 0.5 ? kChoice.passing_m : 0.0;
    if (is_two_sided && choice.is_answer)
        run_.boundaries.learn(answer.lane, *choice.fresh, std::max(trusted_m, sure_m), run_.cones);
    return choice;
}

/// The lane of a frame: the detector's answer if it continues the lane driven so far or outweighs it, else
/// the most probable candidate that continues it; nothing without one.
LapPlanner::Choice LapPlanner::chosen_lane(const LaneAnswer& answer, const Scene& scene,
                                           const DrivableLane& left) {
    std::optional<DrivableLane> seen = fresh_lane(answer, scene, left);
    if (!seen) return {};
    std::optional<DrivableLane> kept;
    double kept_weight = 0.0;
    if (answer.enumeration && !run_.choice.agrees(*seen, left)) {
        double best = kChoice.min_kept_weight;
        for (const LaneCandidate& candidate : answer.enumeration->candidates) {
            const double probability = candidate.confidence.value_or(0.0);
            if (probability < best) continue;
            LaneAnswer other;
            other.status = LaneStatus::found;
            other.lane = candidate.lane;
            std::optional<DrivableLane> lane = fresh_lane(other, scene, left);
            if (!lane || !run_.choice.agrees(*lane, left)) continue;
            // Detectors say how far their answer is trusted. Of a candidate, what it shares with the trusted
            // rest of the lane driven so far is trusted.
            const double shared_m = common_m(*lane, left, kChoice.jump_m, kChoice.near_m);
            lane->trusted_m = std::min(left.trusted_m.value_or(0.0), shared_m);
            kept = std::move(lane);
            kept_weight = best = probability;
        }
    }
    const double weight = answer.confidence.value_or(kChoice.unsure_weight);
    const bool is_answer = run_.choice.take(*seen, left, weight, kept_weight);
    if (is_answer) kept = seen;
    return {std::move(seen), std::move(kept), is_answer};
}

LaneAnswer LapPlanner::named_as_given(LaneAnswer answer) const {
    const auto rename = [&](Lane& lane) {
        for (std::vector<ConeId>* side : {&lane.left, &lane.right}) {
            for (ConeId& id : *side) id = run_.cones.given_id(id);
        }
    };
    rename(answer.lane);
    if (answer.solved) rename(answer.solved->lane);
    if (answer.enumeration) {
        for (LaneCandidate& candidate : answer.enumeration->candidates) rename(candidate.lane);
    }
    for (MergedCone& merged : answer.merged) {
        merged.cone = run_.cones.given_id(merged.cone);
        merged.into = run_.cones.given_id(merged.into);
    }
    return answer;
}

/// The way behind a finish where the course ends: straight on, so that the car can cross it and come to rest.
void LapPlanner::lead_out(Plan& plan) const {
    constexpr double kAtGate_m = 3.0;
    const std::optional<Pose> gate = run_.counter.end();
    if (!gate) return;
    const double to_gate_m = -gate->ahead_m(run_.frame->pose.position);
    const bool is_known = !plan.lane.points.empty();
    if (is_known ? std::abs(plan.lane.length_m - to_gate_m) > kAtGate_m : to_gate_m > kAtGate_m) return;
    const bool is_on_way = std::abs(gate->left_m(run_.frame->pose.position)) <= kChoice.max_offset_m &&
                           gate->heading().dot(run_.frame->pose.heading()) > 0.0;
    if (!is_known && !is_on_way) return;  // a car that is lost elsewhere stays lost
    const double from_m = is_known ? -kAtGate_m : -to_gate_m;
    const double step_m = options_.drivable.step_m;
    const double half_m = options_.drivable.default_width_m / 2.0;
    DrivableLane exit;
    for (double s_m = 0.0; from_m + s_m <= kCourse.stop_m; s_m += step_m) {
        exit.points.push_back({.s_m = s_m,
                               .position = gate->position + (from_m + s_m) * gate->heading(),
                               .heading_rad = turn_rad(0.0, gate->yaw_rad),
                               .width_left_m = half_m,
                               .width_right_m = half_m});
        exit.length_m = s_m;
    }
    if (exit.points.size() < 2) return;
    const double untrusted_m = plan.lane.length_m - plan.safe_m;
    plan.lane = is_known ? extended(plan.lane, exit, step_m) : exit;
    if (untrusted_m < step_m) plan.lane.trusted_m = plan.lane.length_m;
    plan.safe_m = plan.lane.trusted_m.value_or(0.0);
    if (is_known) return;
    plan.state = PlanState::bridging;
    plan.reason = {};
    plan.age_s = run_.frame->time_s - run_.path.time_s();
}

void LapPlanner::finish(Plan& plan) const {
    plan.state = PlanState::finished;
    plan.stop = true;
    const double left_m = kCourse.stop_m - run_.counter.since_line_m();
    plan.lane = stretch(plan.lane, 0.0, left_m, options_.drivable.step_m);
    plan.safe_m = std::min(plan.safe_m, plan.lane.length_m);
}

}  // namespace

std::unique_ptr<Planner> make_lap_planner(const PlannerOptions& options) {
    validate(options);
    return make_lap_planner(options, make_detector(options.detector, options.detector_options));
}

std::unique_ptr<Planner> make_lap_planner(const PlannerOptions& options,
                                          std::unique_ptr<LaneDetector> detector) {
    validate(options);
    return std::make_unique<LapPlanner>(options, std::move(detector));
}

}  // namespace conelane
