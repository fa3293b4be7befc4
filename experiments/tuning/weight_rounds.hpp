#pragma once

#include "experiments/tuning/evaluation.hpp"
#include "model/rld_parameters.hpp"

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
/// How often all scenes of a fit are solved in so many rounds.
[[nodiscard]] std::size_t solves_in(std::size_t rounds);

/// Fits the weights to the scenes of the tracks named. Each round solves the scenes with the weights so far
/// and with some drawn around them, and fits the weights (fit_weights) to all lane graphs that any round has
/// found and to the ground truth where it is feasible. Weights outside the ranges of tuned_parameters(start)
/// are moved to their ends first. Gives the parameters after each round. Rounds see only these tracks; the
/// same seed gives the same for any number of threads as long as no scene runs into the time limit. Throws
/// InvalidInput where w_b is 0.
[[nodiscard]] std::vector<RldParameters> fit_weights_in_rounds(const Evaluation& evaluation,
                                                               const RldParameters& start,
                                                               const std::set<std::string>& tracks,
                                                               const WeightRoundsOptions& options);

}  // namespace conelane::experiments
