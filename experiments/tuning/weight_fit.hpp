#pragma once

#include "conelane/lane_graph.hpp"
#include "conelane/lane_graph_problem.hpp"
#include "conelane/rld_parameters.hpp"
#include "experiments/tuning/evaluation.hpp"
#include "experiments/tuning/parameter_ranges.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace conelane::experiments {

/// The factor of each weight of the objective: of (29), and of the terms for color and shape.
enum class ObjectiveTerm { benefit, spacing, angle, heading, color, unevenness, facing, near_ends };
inline constexpr std::size_t kObjectiveTermCount = 8;

/// The weights in the order of the terms.
inline constexpr std::array<double RldParameters::*, kObjectiveTermCount> kObjectiveWeights{
    &RldParameters::w_b,           &RldParameters::w_s,
    &RldParameters::w_t,           &RldParameters::w_p,
    &RldParameters::w_color,       &RldParameters::unevenness_weight,
    &RldParameters::facing_weight, &RldParameters::near_end_weight};

/// Each term of a lane graph's objective without its weight: the objective is the sum of weights times these
/// terms. Benefit and near ends are at most zero.
using ObjectiveSums = std::array<double, kObjectiveTermCount>;

/// Zero for w_b, w_u and w_v where those are zero. Preconditions: every edge is listed in the problem, and no
/// costs are learned.
[[nodiscard]] ObjectiveSums objective_sums(const LaneGraphProblem& problem, const LaneGraph& graph);

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

struct WeightRoundsOptions {
    std::size_t rounds = 4;
    std::uint64_t seed = 0;
    std::function<void()> on_solved = [] {};  ///< called once for each time that all scenes were solved
};
/// Number of times that all scenes of a fit are solved in this many rounds.
[[nodiscard]] std::size_t solves_in(std::size_t rounds);

/// Fits the weights to the scenes of the named tracks. Each round solves the scenes with the current weights
/// and with some drawn around them, and fits the weights (fit_weights) to all lane graphs found in any round
/// and to the ground truth if it is feasible. Weights outside the ranges of tuned_parameters(start) are first
/// moved to their ends. Returns the parameters after each round. Rounds see only these tracks; the same seed
/// gives the same result for any number of threads as long as no scene reaches the time limit. Throws
/// InvalidInput if w_b is 0.
[[nodiscard]] std::vector<RldParameters> fit_weights_in_rounds(const Evaluation& evaluation,
                                                               const RldParameters& start,
                                                               const std::set<std::string>& tracks,
                                                               const WeightRoundsOptions& options);

}  // namespace conelane::experiments
