#pragma once

#include "conelane/rld_parameters.hpp"

#include <array>
#include <cmath>
#include <span>
#include <string_view>
#include <vector>

namespace conelane::learning {

/// A parameter that tuning changes, and its range.
struct TunedParameter {
    std::string_view key;  ///< as in rld_parameter_fields()
    double RldParameters::*value;
    double lowest;
    double highest;
    bool logarithmic;  ///< equal steps are equal ratios
};

/// The share of a range, such as that of a TunedParameter or a TunableParameter, at which a value is.
template <typename Range>
[[nodiscard]] double share_of(const Range& range, double value) {
    return range.logarithmic ? std::log(value / range.lowest) / std::log(range.highest / range.lowest)
                             : (value - range.lowest) / (range.highest - range.lowest);
}
/// The value at a share.
template <typename Range>
[[nodiscard]] double value_at(const Range& range, double share) {
    return range.logarithmic ? range.lowest * std::pow(range.highest / range.lowest, share)
                             : range.lowest + share * (range.highest - range.lowest);
}

/// The parameters that tuning changes. The others have no effect of their own: w_b sets the unit of the
/// objective, and d_t, theta_t with their weights and limits occur only as w_s / d_t^4, d_t^4 s_crit, w_t /
/// theta_t^4 and theta_t^4 t_crit. An expected angle below pi would prefer bends to straights. The pairing
/// stays too. If the shape costs have a weight in `start`, their parameters are changed instead of the
/// limits.
[[nodiscard]] std::span<const TunedParameter> tuned_parameters(const RldParameters& start);

/// Values of w_color to choose from, beside fixed other parameters; ascending.
inline constexpr std::array kColorWeights{0.0, 0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2};

/// To four decimals: short numbers in files, and the same ones on every machine, whose logarithms differ in
/// the last bits.
[[nodiscard]] double rounded(double value);

/// The parameters that are tuned from this start as a point of the unit cube; values outside a range are
/// moved to its end.
[[nodiscard]] std::vector<double> to_unit_cube(const RldParameters& parameters);

/// `rest`, its limits moved into their ranges, with the parameters tuned from it at a point of the unit cube,
/// rounded to four decimals.
/// Precondition: as many coordinates as tuned parameters, each in [0, 1].
[[nodiscard]] RldParameters from_unit_cube(std::span<const double> point, const RldParameters& rest);

}  // namespace conelane::learning
