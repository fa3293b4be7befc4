#pragma once

#include "conelane/drivable_lane.hpp"
#include "detectors/planner/lap_planner_settings.hpp"

#include <span>

namespace conelane {

/// A movement of the map: a rotation about a place, then a translation.
struct RigidShift {
    Point about{0.0, 0.0};
    double turn_rad = 0.0;
    Point by{0.0, 0.0};

    [[nodiscard]] Point operator()(const Point& point) const;
};

/// The same points in the moved map.
void move(std::span<DrivablePoint> points, const RigidShift& shift);

/// The place of a cone as remembered and as seen now.
struct PlacePair {
    Point remembered;
    Point seen;
};

/// The shift that most of the pairs share, if it exceeds noise; absent if the cones have not moved, are too
/// few, or moved differently.
[[nodiscard]] std::optional<RigidShift> common_shift(std::span<const PlacePair> pairs,
                                                     const ShiftSettings& settings);

/// The same without known pairs: the translation that brings most of the seen cones onto remembered ones.
[[nodiscard]] std::optional<RigidShift> common_shift(std::span<const Point> remembered,
                                                     std::span<const Point> seen,
                                                     const ShiftSettings& settings);

}  // namespace conelane
