#pragma once

#include "conelane/drivable_lane.hpp"
#include "detectors/planner/lap_planner_settings.hpp"
#include "detectors/planner/rigid_shift.hpp"

#include <optional>

namespace conelane {

/// Decides between the lane driven by and a new one that jumps away from it near the car.
///
/// Each frame speaks for a lane with a weight, the probability that its detector gives. What spoke for the
/// lane driven by has to be outweighed by what speaks for the new one, in two frames at least. Both fade from
/// frame to frame: what was sure of a stretch behind the car says little of the one ahead. So frames that are
/// little sure lead nowhere against sure ones, and a wrong lane is left after some frames.
class LaneChoice {
  public:
    explicit LaneChoice(const LaneChoiceSettings& settings) : settings_(settings) {}

    /// Whether a lane goes on where the one driven by went, or that has too little left to say. One that ends
    /// where the lane driven by goes on does not. `left`: what is left of the lane driven by; without points
    /// there is none.
    [[nodiscard]] bool agrees(const DrivableLane& lane, const DrivableLane& left) const;
    /// Whether `fresh`, for which the frame speaks with `weight`, is driven by from now on. `kept_weight`:
    /// with which the frame speaks for the lane driven by where `fresh` does not agree with it, 0 where it
    /// does not.
    [[nodiscard]] bool take(const DrivableLane& fresh, const DrivableLane& left, double weight = 1.0,
                            double kept_weight = 0.0);
    void move_along(const RigidShift& shift);
    void clear();

  private:
    [[nodiscard]] bool is_spent(const DrivableLane& left) const;

    LaneChoiceSettings settings_;
    double support_ = 0.0;  ///< weights of the frames that spoke for the lane driven by
    std::optional<DrivableLane> challenger_;
    double challenger_support_ = 0.0;
    int challenger_frames_ = 0;
};

}  // namespace conelane
