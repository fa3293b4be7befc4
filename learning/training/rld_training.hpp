#pragma once

#include "conelane/learned_costs.hpp"
#include "conelane/rld_parameters.hpp"
#include "learning/training/front_scenes.hpp"
#include "learning/training/rld_learner.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace conelane::learning {

/// The parameters for learning costs: all other costs are 0, and the limits allow most true lanes, also with
/// missed cones.
[[nodiscard]] RldParameters rld_learning_parameters();

/// The costs of the shipped set `shape` as linear learned costs, with a constant moved from edges to turns
/// and ends, which changes no optimum.
[[nodiscard]] LearnedCosts shape_as_learned_costs();

/// Linear costs with this number of hidden units, drawn by the seed, which contribute almost nothing. They do
/// not depend on colours and confidences.
/// Precondition: `linear` has none.
[[nodiscard]] LearnedCosts with_hidden_units(const LearnedCosts& linear, std::size_t units,
                                             std::uint64_t seed);

/// Most are explained by option_fields.
struct RldTrainingOptions : DrawnTrainingOptions {
    RldTrainingOptions() {
        scenes.colored_share = 0.0;
        scenes.noise_share = 0.0;
        scenes.highest_rate = 0.6;
    }
    /// Limits and costs to which the learned ones are added. If they have learned costs, the training begins
    /// with them, and linear ones get hidden units; otherwise it begins with shape_as_learned_costs.
    RldParameters parameters = rld_learning_parameters();
    std::string parameters_hash;  ///< set by option_fields
    RldMargin margin;
    std::size_t units = 16;
    std::int64_t max_work = 15'000'000;
    std::size_t steps = 2000;
    double learning_rate = 5e-3;  ///< of Adam, falls to 0 along a cosine
};
/// Those of the record, which determine the costs together with the courses, and how it is run.
[[nodiscard]] OptionFields option_fields(RldTrainingOptions& options);

/// Learns costs from courses by the structured hinge loss of RldLearner, with Adam. The same courses, options
/// (except run_fields) and build give the same costs to the last bit, also if a run was stopped and resumed
/// from its checkpoint. `say` gets a line now and then. Throws InvalidInput if an option is out of range,
/// InputError if the checkpoint is of another training.
[[nodiscard]] LearnedCosts train_rld(const std::vector<Track>& courses, const RldTrainingOptions& options,
                                     const std::function<void(const std::string&)>& say);

struct RldTrainingRun {
    RldParameters parameters;  ///< those of the options, with the learned costs
    std::string record;        ///< JSON object: everything that determines the costs, the commit
};
/// From SPECs of load_tracks to parameters with learned costs. The record names tracks, not files. Runs
/// without annotated boundaries are left out. Throws InputError or InvalidInput.
[[nodiscard]] RldTrainingRun run_rld_training(const std::vector<std::string>& tracks,
                                              const RldTrainingOptions& options,
                                              const std::function<void(const std::string&)>& say);

}  // namespace conelane::learning
