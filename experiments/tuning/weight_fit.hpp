#pragma once

#include "experiments/tuning/objective_sums.hpp"
#include "experiments/tuning/parameter_ranges.hpp"
#include "model/rld_parameters.hpp"

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

/// Mean over the scenes of the expected value where each scene's lane graph is drawn with probability
/// proportional to exp(-kSharpness objective / w_b): the value of the one of least cost, made smooth. 0
/// without scenes. Writes the derivatives by the logarithms of the weights to `gradient` where that is not
/// null; 0 for w_b, the unit, which no fit moves. Preconditions: no scene without lane graphs; w_b > 0.
inline constexpr double kSharpness = 8.0;
[[nodiscard]] double expected_value(std::span<const RatedGraphs> scenes, const RldParameters& parameters,
                                    ObjectiveSums* gradient);

/// The parameters with weights that make expected_value as large as NLopt's MMA finds from those of
/// `start`, among the weights that tuned_parameters(start) moves and in their ranges, rounded to four
/// decimals.
[[nodiscard]] RldParameters fit_weights(std::span<const RatedGraphs> scenes, const RldParameters& start);

}  // namespace conelane::experiments
