#pragma once

#include "conelane/rld_parameters.hpp"
#include "experiments/tuning/evaluation.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <vector>

namespace conelane::experiments {

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
