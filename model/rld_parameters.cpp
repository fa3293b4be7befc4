#include "model/rld_parameters.hpp"

#include "model/invalid_input.hpp"

#include <array>
#include <cmath>
#include <string>

namespace conelane {
namespace {

constexpr double kLongest_m = 1000.0;
constexpr double kLargestWeight = 1e6;
using P = RldParameters;

constexpr std::array<RldParameterField, 15> kFields{{
    {"d_e", &P::d_e, "m", 0.0, kLongest_m, true, "expected spacing"},
    {"d_t", &P::d_t, "m", 0.0, kLongest_m, false, "spacing threshold"},
    {"theta_e", &P::theta_e, "rad", 0.0, std::numbers::pi, true, "expected interior angle"},
    {"theta_t", &P::theta_t, "rad", 0.0, std::numbers::pi, false, "angle threshold"},
    {"w_s", &P::w_s, "1", 0.0, kLargestWeight, true, "weight of the spacing cost"},
    {"w_t", &P::w_t, "1", 0.0, kLargestWeight, true, "weight of the angle cost"},
    {"w_p", &P::w_p, "1", 0.0, kLargestWeight, true, "weight of the heading cost"},
    {"w_b", &P::w_b, "1", 0.0, kLargestWeight, true, "benefit of an edge"},
    {"d_min", &P::d_min, "m", 0.0, kLongest_m, true, "smallest distance between the boundaries"},
    {"d_h", &P::d_h, "m", 0.0, kLongest_m, true, "radius of the heading constraint"},
    {"theta_heading", &P::theta_heading, "rad", 0.0, std::numbers::pi / 2, true,
     "angle of the heading constraint"},
    {"d_near", &P::d_near, "m", 0.0, kLongest_m, true, "radius of the near endpoints"},
    {"d_max", &P::d_max, "m", 0.0, kLongest_m, true, "largest distance of the far endpoints"},
    {"s_crit", &P::s_crit, "1", 0.0, kLargestWeight, true, "largest spacing cost"},
    {"t_crit", &P::t_crit, "1", 0.0, kLargestWeight, true, "largest angle cost"},
}};

}  // namespace

std::string_view to_string(Pairing pairing) {
    return pairing == Pairing::paper ? "paper" : "near_far";
}

std::span<const RldParameterField> rld_parameter_fields() {
    return kFields;
}

void validate(const RldParameters& parameters) {
    for (const RldParameterField& field : kFields) {
        const double value = parameters.*field.value;
        const bool above = field.lowest_allowed ? value >= field.lowest : value > field.lowest;
        if (!std::isfinite(value) || !above || value > field.highest) {
            throw InvalidInput(std::string(field.key),
                               "must be in " + std::string(field.lowest_allowed ? "[" : "(") +
                                   std::to_string(field.lowest) + ", " + std::to_string(field.highest) +
                                   "] " + std::string(field.unit == "1" ? "" : field.unit));
        }
    }
    if (!(parameters.w_color >= 0.0 && parameters.w_color <= kLargestWeight)) {
        throw InvalidInput("w_color", "must be in [0, " + std::to_string(kLargestWeight) + "]");
    }
}

}  // namespace conelane
