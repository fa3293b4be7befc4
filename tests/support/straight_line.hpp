#pragma once

#include "conelane/drivable_lane.hpp"

namespace conelane::tests {

/// An open lane straight on from `begin` along `heading_rad`, 1.75 m wide to either side, in steps of 0.5 m.
inline DrivableLane straight_line(const Point& begin, double heading_rad, double length_m) {
    constexpr double kStep_m = 0.5;
    DrivableLane lane;
    for (int i = 0; kStep_m * i <= length_m + 1e-9; ++i) {
        const double s_m = kStep_m * i;
        lane.points.push_back({.s_m = s_m,
                               .position = begin + s_m * Point(std::cos(heading_rad), std::sin(heading_rad)),
                               .heading_rad = heading_rad,
                               .width_left_m = 1.75,
                               .width_right_m = 1.75});
    }
    lane.length_m = length_m;
    lane.trusted_m = length_m;
    return lane;
}

}  // namespace conelane::tests
