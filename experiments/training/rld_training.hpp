#pragma once

#include "conelane/learned_costs.hpp"
#include "conelane/rld_parameters.hpp"
#include "evaluation/world/track.hpp"
#include "experiments/training/front_scenes.hpp"
#include "experiments/training/rld_learner.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace conelane::experiments {

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

struct RldTrainingOptions {
    /// Limits and costs to which the learned ones are added. If they have learned costs, the training begins
    /// with them, and linear ones get hidden units; otherwise it begins with shape_as_learned_costs.
    RldParameters parameters = rld_learning_parameters();
    FrontSceneOptions scenes{.colored_share = 0.0, .noise_share = 0.0, .highest_rate = 0.6};
    RldMargin margin;
    std::size_t units = 16;  ///< hidden units of each network; 0 for linear costs
    /// Limit of the search for a rival, in steps of about a nanosecond.
    std::int64_t max_work = 15'000'000;
    std::size_t draws_per_step = 8;  ///< changed courses in each step of Adam
    std::size_t steps = 2000;
    double learning_rate = 5e-3;     ///< of Adam, falls to 0 along a cosine
    std::size_t report_every = 100;  ///< steps
    std::uint64_t seed = 0;
    unsigned threads = 1;                ///< the costs are the same with any number
    std::string checkpoint;              ///< file to resume from, written regularly; none if empty
    std::size_t checkpoint_every = 200;  ///< steps
};

/// Throws InvalidInput naming the option that is out of its range.
void validate(const RldTrainingOptions& options);

/// Everything that determines the costs, as one line of JSON.
[[nodiscard]] std::string describe_training(const std::vector<Track>& courses,
                                            const RldTrainingOptions& options);

struct RldProgress {
    std::size_t step = 0;
    std::size_t steps = 0;
    // Since the last report:
    std::size_t scenes = 0;
    double allowed = 0.0;  ///< share of the scenes whose truth is a lane graph of the problem
    // Of those, shares and means:
    double proven = 0.0;  ///< searches for a rival that ended with a proof
    double found = 0.0;   ///< scenes without a cheaper rival
    double hinge = 0.0;   ///< mean loss
};

/// Learns costs from courses by the structured hinge loss of RldLearner, with Adam. The same courses, options
/// (except `threads` and files) and build give the same costs to the last bit, also if a run was stopped and
/// resumed from its checkpoint. Throws InvalidInput if an option is out of range, InputError if the
/// checkpoint is of another training.
[[nodiscard]] LearnedCosts train_rld(const std::vector<Track>& courses, const RldTrainingOptions& options,
                                     const std::function<void(const RldProgress&)>& report);

}  // namespace conelane::experiments
