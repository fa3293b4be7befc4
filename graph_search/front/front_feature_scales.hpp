#pragma once

#include <algorithm>

namespace conelane {

// Divisors that bring values to about 1, and limits at which values are clamped.
inline constexpr double kLengthScale_m = 4.0;
inline constexpr double kViewScale_m = 10.0;
inline constexpr double kFarBeyond = 2.0;
inline constexpr double kPartnerReach_m = 3.0;
inline constexpr double kDefaultWidth = 0.9;
inline constexpr float kMaxCounted = 3.0F;

inline float scaled(double value, double unit, double most = 4.0) {
    return static_cast<float>(std::clamp(value / unit, -most, most));
}

}  // namespace conelane
