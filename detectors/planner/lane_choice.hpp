#pragma once

#include "conelane/drivable_lane.hpp"
#include "detectors/planner/lap_planner_settings.hpp"
#include "detectors/planner/rigid_shift.hpp"

#include <optional>

namespace conelane {

/// Decides whether a new lane is driven by. One that goes on where the last one went is; one that jumps near
/// the car has to be seen by a second frame. So one wrong frame leads nowhere, and a wrong lane is left after
/// as many frames as spoke for it, settings.max_support at most.
class LaneChoice {
  public:
    explicit LaneChoice(const LaneChoiceSettings& settings) : settings_(settings) {}

    /// `left`: what is left of the lane driven by; without points there is none.
    [[nodiscard]] bool take(const DrivableLane& fresh, const DrivableLane& left);
    void move_along(const RigidShift& shift);
    void clear();

  private:
    LaneChoiceSettings settings_;
    double support_ = 0.0;  ///< frames that spoke for the lane driven by
    std::optional<DrivableLane> challenger_;
    double challenger_support_ = 0.0;
};

}  // namespace conelane
