#pragma once

#include "model/rld_parameters.hpp"

#include <span>
#include <string_view>
#include <vector>

namespace conelane::experiments {

/// A parameter that tuning moves, and how far.
struct TunedParameter {
    std::string_view key;  ///< as in rld_parameter_fields()
    double RldParameters::*value;
    double lowest;
    double highest;
    bool logarithmic;  ///< equal steps are equal ratios
};

/// What tuning moves. The rest would move nothing: w_b sets the unit of the objective, and d_t, theta_t with
/// their weights and limits only enter as w_s / d_t^4, d_t^4 s_crit, w_t / theta_t^4 and theta_t^4 t_crit. An
/// expected angle below pi would prefer bends to straights. The pairing stays as well.
/// Where the shape costs have a weight in `start`, their parameters are moved in place of the limits.
[[nodiscard]] std::span<const TunedParameter> tuned_parameters(const RldParameters& start);

/// To four decimals: short numbers in files, and the same ones on every machine, whose logarithms differ in
/// the last bits.
[[nodiscard]] double rounded(double value);

/// The parameters that are tuned from this start as a point of the unit cube; what lies outside its range is
/// moved to its end.
[[nodiscard]] std::vector<double> to_unit_cube(const RldParameters& parameters);

/// `rest`, its limits moved into their ranges, with the parameters tuned from it at a point of the unit cube,
/// rounded to four decimals.
/// Precondition: as many coordinates as tuned parameters, each in [0, 1].
[[nodiscard]] RldParameters from_unit_cube(std::span<const double> point, const RldParameters& rest);

}  // namespace conelane::experiments
