#include "learning/tuning/parameter_ranges.hpp"

#include <algorithm>

namespace conelane::learning {
namespace {

using P = RldParameters;

/// A limit that cuts off lanes of an unseen track costs more than a tight limit gains on the seen tracks:
/// with all limits free, a fold lost 12 points of accuracy on a track with cones 0.9 m apart. So the ranges
/// of limits begin at values that exclude no real lane: turns of 70 degrees (t_crit), spacings 2.7 m off d_e
/// (s_crit), lanes 2.8 m wide (d_min), first cones 5 m away (d_near), far ends the widest lane apart (d_max),
/// two edges near a car that is across a bend (d_h, theta_heading). d_e ends at the largest spacing of the
/// rules.
///
/// With shape costs, the limits stay: these costs distinguish false edges without excluding true ones, and
/// with tuned limits fewer lanes of held-out tracks were accurate.
constexpr std::size_t kShape = 7;
constexpr std::size_t kCosts = 4;
constexpr std::size_t kLimits = 7;
constexpr std::array<TunedParameter, kShape + kCosts + kLimits> kTuned{{
    {"w_u", &P::unevenness_weight, 0.01, 3.0, true},
    {"w_v", &P::facing_weight, 0.02, 5.0, true},
    {"w_n", &P::near_end_weight, 0.02, 5.0, true},
    {"d_w", &P::lane_width_m, 3.0, 5.0, false},
    {"d_v", &P::facing_distance_m, 0.5, 4.0, true},
    {"theta_v", &P::facing_angle_rad, 0.1, 1.5, true},
    {"d_l", &P::facing_length_m, 0.5, 10.0, true},
    {"d_e", &P::d_e, 1.5, 5.0, false},
    {"w_s", &P::w_s, 0.01, 3.0, true},
    {"w_t", &P::w_t, 0.02, 5.0, true},
    {"w_p", &P::w_p, 0.005, 10.0, true},
    {"d_min", &P::d_min, 1.5, 2.8, false},
    {"d_h", &P::d_h, 5.5, 12.0, false},
    {"theta_heading", &P::theta_heading, 1.2, 1.55, false},
    {"d_near", &P::d_near, 5.1, 12.0, false},
    {"d_max", &P::d_max, 6.5, 12.0, false},
    {"s_crit", &P::s_crit, 7.0, 20.0, true},
    {"t_crit", &P::t_crit, 3.5, 10.0, true},
}};

}  // namespace

double rounded(double value) {
    constexpr double kStepsPerUnit = 1e4;
    return std::round(value * kStepsPerUnit) / kStepsPerUnit;
}

std::span<const TunedParameter> tuned_parameters(const RldParameters& start) {
    const std::span<const TunedParameter> all(kTuned);
    return has_shape_costs(start) ? all.first(kShape + kCosts) : all.last(kCosts + kLimits);
}

std::vector<double> to_unit_cube(const RldParameters& parameters) {
    std::vector<double> point;
    for (const TunedParameter& tuned : tuned_parameters(parameters)) {
        point.push_back(share_of(tuned, std::clamp(parameters.*tuned.value, tuned.lowest, tuned.highest)));
    }
    return point;
}

RldParameters from_unit_cube(std::span<const double> point, const RldParameters& rest) {
    RldParameters parameters = rest;
    for (const TunedParameter& limit : std::span(kTuned).last(kLimits)) {
        parameters.*limit.value = std::clamp(rest.*limit.value, limit.lowest, limit.highest);
    }
    const std::span<const TunedParameter> tuned_ones = tuned_parameters(rest);
    for (std::size_t i = 0; i < tuned_ones.size(); ++i) {
        const TunedParameter& tuned = tuned_ones[i];
        parameters.*tuned.value = std::clamp(rounded(value_at(tuned, point[i])), tuned.lowest, tuned.highest);
    }
    return parameters;
}

}  // namespace conelane::learning
