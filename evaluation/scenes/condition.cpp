#include "evaluation/scenes/condition.hpp"

#include <array>
#include <numbers>

namespace conelane {

std::span<const Condition> named_conditions() {
    constexpr double kDegree_rad = std::numbers::pi / 180.0;
    static const std::array<Condition, 3> conditions{{
        {"paper", 0.0, 0.0, 0.0, 0.0, false},
        {"car", 0.1, 0.3, 5.0 * kDegree_rad, 0.05, true},
        {"harsh", 0.2, 0.5, 8.0 * kDegree_rad, 0.1, true},
    }};
    return conditions;
}

}  // namespace conelane
