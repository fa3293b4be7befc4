#include "conelane/rld_parameters.hpp"

#include "conelane/invalid_input.hpp"
#include "conelane/learned_costs.hpp"

#include <array>
#include <string>

namespace conelane {
namespace {

constexpr double kMaxLength_m = 1000.0;
/// With more than three missing cones, an edge carries no information.
constexpr double kMaxGap_m = 20.0;
constexpr double kMaxWeight = 1e6;
constexpr double kMaxCount = 1e6;
/// Smallest divisor of a difference [m] or [rad]. Below a millimetre, costs depend on rounding.
constexpr double kMinThreshold = 1e-3;
using P = RldParameters;

constexpr std::array<RldParameterField, 15> kFields{{
    {"d_e", &P::d_e, "m", 0.0, kMaxLength_m, "expected spacing"},
    {"d_t", &P::d_t, "m", kMinThreshold, kMaxLength_m, "spacing threshold"},
    {"theta_e", &P::theta_e, "rad", 0.0, std::numbers::pi, "expected interior angle"},
    {"theta_t", &P::theta_t, "rad", kMinThreshold, std::numbers::pi, "angle threshold"},
    {"w_s", &P::w_s, "1", 0.0, kMaxWeight, "weight of the spacing cost"},
    {"w_t", &P::w_t, "1", 0.0, kMaxWeight, "weight of the angle cost"},
    {"w_p", &P::w_p, "1", 0.0, kMaxWeight, "weight of the heading cost"},
    {"w_b", &P::w_b, "1", 0.0, kMaxWeight, "benefit of an edge"},
    {"d_min", &P::d_min, "m", 0.0, kMaxLength_m, "smallest distance between the boundaries"},
    {"d_h", &P::d_h, "m", 0.0, kMaxLength_m, "radius of the heading constraint"},
    {"theta_heading", &P::theta_heading, "rad", 0.0, std::numbers::pi / 2, "angle of the heading constraint"},
    {"d_near", &P::d_near, "m", 0.0, kMaxLength_m, "radius of the near endpoints"},
    {"d_max", &P::d_max, "m", 0.0, kMaxLength_m, "largest distance of the far endpoints"},
    {"s_crit", &P::s_crit, "1", 0.0, kMaxWeight, "largest spacing cost"},
    {"t_crit", &P::t_crit, "1", 0.0, kMaxWeight, "largest angle cost"},
}};

constexpr std::array<RldParameterField, 14> kExtraFields{{
    {"w_color", &P::w_color, "1", 0.0, kMaxWeight, "weight of the colour cost"},
    {"w_u", &P::unevenness_weight, "1", 0.0, kMaxWeight, "weight of uneven spacing"},
    {"w_v", &P::facing_weight, "1", 0.0, kMaxWeight, "weight of the facing cost"},
    {"w_n", &P::near_end_weight, "1", 0.0, kMaxWeight, "benefit of a near endpoint beside the car"},
    {"d_w", &P::lane_width_m, "m", 0.0, kMaxLength_m, "expected width of the lane"},
    {"d_v", &P::facing_distance_m, "m", kMinThreshold, kMaxLength_m, "facing threshold"},
    {"theta_v", &P::facing_angle_rad, "rad", kMinThreshold, std::numbers::pi, "facing angle threshold"},
    {"d_l", &P::facing_length_m, "m", kMinThreshold, kMaxLength_m, "facing length threshold"},
    {"d_gap", &P::d_gap, "m", 0.0, kMaxGap_m, "largest length of an edge over a gap"},
    {"theta_gap", &P::theta_gap, "rad", 0.0, std::numbers::pi, "largest angle at an edge over a gap"},
    {"d_clear", &P::d_clear, "m", 0.0, kMaxLength_m,
     "distance of an edge over a gap from the cones beside it"},
    {"d_side", &P::d_side, "m", 0.0, kMaxLength_m, "distance of the near endpoints from the car's axis"},
    {"k_edge", &P::nearest_of_edge, "1", 0.0, kMaxCount,
     "an edge joins a cone with one of its so many nearest"},
    {"k_gap", &P::nearest_of_gap, "1", 0.0, kMaxCount, "the same for an edge over a gap"},
}};

void require_in_range(const RldParameterField& field, const RldParameters& parameters) {
    const double value = parameters.*field.value;
    if (!(value >= field.lowest && value <= field.highest)) {
        throw InvalidInput(std::string(field.key), "must be in [" + std::to_string(field.lowest) + ", " +
                                                       std::to_string(field.highest) + "] " +
                                                       std::string(field.unit == "1" ? "" : field.unit));
    }
}

}  // namespace

std::string_view to_string(Pairing pairing) {
    return pairing == Pairing::paper ? "paper" : "near_far";
}

std::span<const RldParameterField> rld_parameter_fields() {
    return kFields;
}

std::span<const RldParameterField> rld_extra_fields() {
    return kExtraFields;
}

RldParameters with_shape_costs(RldParameters parameters) {
    if (has_shape_costs(parameters)) return parameters;
    parameters.d_e = 2.8;
    parameters.w_s = 0.1;
    parameters.w_t = 0.7;
    parameters.d_min = 2.8;
    parameters.theta_heading = 1.3;
    parameters.s_crit = 7.0;
    parameters.unevenness_weight = 0.4;
    parameters.facing_weight = 0.8;
    parameters.near_end_weight = 1.2;
    return parameters;
}

bool has_shape_costs(const RldParameters& parameters) {
    return parameters.unevenness_weight > 0.0 || parameters.facing_weight > 0.0 ||
           parameters.near_end_weight > 0.0;
}

void validate(const RldParameters& parameters) {
    for (const RldParameterField& field : kFields) require_in_range(field, parameters);
    for (const RldParameterField& field : kExtraFields) require_in_range(field, parameters);
    if (parameters.learned_costs) validate(*parameters.learned_costs);
}

}  // namespace conelane
