#pragma once

#include "conelane/drivable_lane.hpp"
#include "conelane/scene.hpp"

#include <optional>

namespace conelane {

/// The place of a car on a lane: the nearest point that runs within 90 degrees of the car's heading.
struct LaneFoot {
    double s_m = 0.0;
    double offset_m = 0.0;  ///< distance of the car
};
/// Among what lies between two arc lengths; nothing where no point of it runs with the car.
[[nodiscard]] std::optional<LaneFoot> foot_on(const DrivableLane& lane, const Pose& pose, double from_s_m,
                                              double to_s_m);

/// The point at an arc length: between two points straight on, on a closed lane around. Precondition: the
/// lane has a point.
[[nodiscard]] DrivablePoint point_at(const DrivableLane& lane, double s_m);

/// What of a lane lies between two arc lengths, as an open lane that begins at 0; of a closed one once around
/// at most. No points where that is shorter than a step.
[[nodiscard]] DrivableLane stretch(const DrivableLane& lane, double from_s_m, double to_s_m, double step_m);

/// How far apart two open lanes are within an arc length of the first one, as far as both go [m].
[[nodiscard]] double jump_m(const DrivableLane& lane, const DrivableLane& other, double within_m);

/// The lane with a beginning at the car where it begins ahead: along `before`, the lane driven so far, where
/// that leads to it, else in one bend from the car. Nothing where it is more than 12 m away, or for a bend
/// too far aside: more than 2.5 m and three tenths of the way ahead. Nothing either where it begins at the
/// car and runs across its heading, by more than 0.9 rad.
[[nodiscard]] std::optional<DrivableLane> begun_at_car(const DrivableLane& lane, const Pose& pose,
                                                       const DrivableLane* before, double step_m);

/// The lane, and where it ends what `before` knows to follow, if that runs into it smoothly.
[[nodiscard]] DrivableLane extended(const DrivableLane& lane, const DrivableLane& before, double step_m);

/// The lane, its first metres drawn halfway aside to `before`, the lane driven so far, where both run nearly
/// the same way: what noise moves from frame to frame moves half as much. Where they are far apart, and where
/// the lane would come near a boundary, it stays.
[[nodiscard]] DrivableLane steadied(const DrivableLane& lane, const DrivableLane& before, double step_m);

}  // namespace conelane
