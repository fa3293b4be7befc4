#pragma once

#include "conelane/rld_parameters.hpp"
#include "experiments/tuning/objective_sums.hpp"
#include "experiments/tuning/parameter_ranges.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace conelane::experiments {

/// A tuned parameter that is a weight of the objective, and the term it multiplies.
struct TunedWeight {
    TunedParameter parameter;
    std::size_t term;
};
/// Those among tuned_parameters(start).
[[nodiscard]] std::vector<TunedWeight> tuned_weights(const RldParameters& start);

/// One lane graph that a scene allows.
struct RatedGraph {
    ObjectiveSums sums{};
    double value = 0.0;  ///< of its lane, in [0, 1]
};
/// Some of a scene's lane graphs.
using RatedGraphs = std::vector<RatedGraph>;

/// Mean over the scenes of the expected value if each scene's lane graph is drawn with probability
/// proportional to exp(-kSharpness objective / w_b): a smooth form of the value of the lane graph of least
/// cost. 0 without scenes. Writes the derivatives with respect to the logarithms of the weights to `gradient`
/// if that is not null; 0 for w_b, the unit, which no fit changes. Preconditions: no scene without lane
/// graphs; w_b > 0.
inline constexpr double kSharpness = 8.0;
[[nodiscard]] double expected_value(std::span<const RatedGraphs> scenes, const RldParameters& parameters,
                                    ObjectiveSums* gradient);

/// The parameters with weights that maximise expected_value as far as NLopt's MMA finds, starting from those
/// of `start`, among the weights that tuned_parameters(start) changes and in their ranges, rounded to four
/// decimals.
[[nodiscard]] RldParameters fit_weights(std::span<const RatedGraphs> scenes, const RldParameters& start);

}  // namespace conelane::experiments
