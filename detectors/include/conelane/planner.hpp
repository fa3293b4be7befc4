#pragma once

#include "conelane/detectors.hpp"
#include "conelane/drivable_lane.hpp"
#include "conelane/lane_detector.hpp"
#include "conelane/scene.hpp"

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// The path to drive in each frame of an event, from the start line to the stop.
///
///     auto planner = conelane::make_planner({.mission = conelane::Mission::trackdrive, .laps = 10});
///     conelane::Plan plan = planner->update(frame, {.time_limit_ms = 20.0});
///     if (plan.lane.points.empty()) brake();
///     else steer_along(plan.lane, plan.stop);
namespace conelane {

/// The dynamic events of Formula Student.
enum class Mission { trackdrive, autocross, acceleration, skidpad };
[[nodiscard]] std::string_view to_string(Mission mission);
/// The mission with this name, as `to_string` spells it. Throws InvalidInput naming `mission` and listing
/// all.
[[nodiscard]] Mission mission_named(std::string_view name);

enum class PlanState {
    searching,  ///< no lane has been found yet
    following,  ///< the lane is of this frame, or of a known course, which this frame confirms
    bridging,   ///< this frame gives no lane to follow: the rest of an earlier lane, see Plan::age_s
    lost,       ///< no rest of an earlier lane; there is no path
    finished,   ///< the last line is crossed; the path is the stretch to come to rest on
};
[[nodiscard]] std::string_view to_string(PlanState state);

/// Id of a cone without an id: the planner recognises it by its place.
inline constexpr ConeId kNoId = std::numeric_limits<ConeId>::min();

/// What the car sees, or its map, at one moment. Pose and cones are in one frame of reference, the map's.
struct Frame {
    double time_s = 0.0;  ///< of any clock that never goes back [s]
    Pose pose;
    std::vector<Cone> cones;  ///< in any order; ids other than kNoId are distinct
};

/// What to drive.
struct Plan {
    PlanState state = PlanState::searching;
    /// Begins beside the car. Empty if state is searching or lost, and once the stretch to stop on is driven.
    DrivableLane lane;
    double safe_m = 0.0;  ///< trusted length of `lane`; if bridging, what is left of it
    double age_s = 0.0;   ///< age of the frame that the lane is from; 0 if following
    int lap = 0;          ///< laps driven; in skidpad completed circles, in acceleration 0
    bool stop = false;    ///< the last line is crossed: come to rest before the end of `lane`
    /// Distance along `lane` to the line past which the car has to stop; absent while that line is not on
    /// the lane, not known, or crossed.
    std::optional<double> stop_line_m;
    /// Why the course of the lap before is not trusted to its end, why the path is lost, or that the frame is
    /// not later than the one before; else empty.
    std::string_view reason;
    std::string_view phase;  ///< skidpad: approach, right 1, right 2, left 1, left 2, exit; else empty
    LaneAnswer answer;       ///< the detector's, to this frame; a cone without an id has one from the planner
};

struct PlannerOptions {
    Mission mission = Mission::trackdrive;  ///< the event
    std::string detector = "front-warm";    ///< a name of `detectors`
    DetectorOptions detector_options = {};  ///< of that detector
    std::optional<int> laps = {};           ///< trackdrive: 10 if absent; autocross: 1. At least 1
    DrivableOptions drivable = {};          ///< of the lanes in plans; step_m at most 5
    double max_age_s = 1.0;                 ///< an older lane is not driven; at least 0
};

/// A planner of one run. It serves one thread; planners are independent of each other.
class Planner {
  public:
    Planner() = default;
    Planner(const Planner&) = delete;
    Planner& operator=(const Planner&) = delete;
    virtual ~Planner();

    /// Throws InvalidInput if the frame is invalid or the limit is NaN; the planner then stays unchanged. A
    /// frame without cones is valid. A frame that is not later than the last one changes nothing: it returns
    /// the last plan. Unless the two frames are equal, that plan then says bridging instead of following, and
    /// safe_m is less by the distance between the two poses.
    [[nodiscard]] virtual Plan update(const Frame& frame, const DetectionLimits& limits = {}) = 0;

    /// The whole course, closed, while a lap is known; always absent in acceleration and skidpad. After more
    /// than 6 m driven without a lane, no lap is known until another one is complete.
    [[nodiscard]] virtual std::optional<DrivableLane> course() const = 0;

    /// Forgets the run.
    virtual void reset() = 0;
};

/// Throws InvalidInput naming the option that is out of range or that the mission does not use, and for the
/// detector as make_detector does.
[[nodiscard]] std::unique_ptr<Planner> make_planner(const PlannerOptions& options = {});

}  // namespace conelane
