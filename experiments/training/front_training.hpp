#pragma once

#include "evaluation/formats/scene_set.hpp"
#include "evaluation/scoring/calibration.hpp"
#include "experiments/training/front_judge_learner.hpp"
#include "experiments/training/front_learner.hpp"
#include "experiments/training/front_scenes.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace conelane::experiments {

struct FrontTrainingOptions {
    FrontSceneOptions scenes;
    FrontLossOptions loss;
    /// Weights with which the training begins, instead of random ones, and their name in the record.
    std::optional<FrontWeights> initial;
    std::string initial_name;
    /// Only FrontWeights::colored is learned. It begins with that of `initial`, or with its first set if it
    /// has none. Answers to scenes without colors do not change. Needs `initial`.
    bool only_colors = false;
    /// Inputs of the cost that get no weight, by their names in the feature tables. For ablations.
    std::vector<std::string> without;
    std::size_t draws_per_step = 8;     ///< changed courses in each step of Adam
    std::size_t imitation_steps = 800;  ///< of teacher forcing
    std::size_t search_steps = 7000;    ///< through the search, after these
    std::size_t judge_steps = 4000;     ///< of FrontJudge, after these
    /// Networks of the judge that are learned in these steps; the others stay as they are. `usable` is
    /// no input of the others, so without `rank` and `right` the order of the lanes does not change.
    std::vector<std::string> judge_parts{"rank", "usable", "right"};
    double imitation_rate = 3e-3;  ///< learning rates of Adam, which fall to 0 along a cosine
    double search_rate = 1e-3;
    double judge_rate = 2e-3;
    /// Target share of lanes that are right up to their trusted length.
    double trusted = 0.995;
    std::size_t trust_draws = 1000;  ///< changed courses on which least_trust is chosen
    /// These are drawn from the following courses, or from those that are learned from.
    std::vector<Track> trust_courses;
    std::size_t figures_every = 1000;  ///< steps between two measurements on the scenes held out
    std::uint64_t seed = 0;
    unsigned threads = 1;                ///< the weights are the same with any number
    std::string checkpoint;              ///< file to resume from, written regularly; none if empty
    std::size_t checkpoint_every = 200;  ///< steps
};

/// Throws InvalidInput naming the option that is out of its range.
void validate(const FrontTrainingOptions& options);

/// Quality of the lanes of a detector with these weights.
struct FrontFigures {
    std::size_t scenes = 0;  ///< those that count
    double usable = 0.0;     ///< share
    // Over the scenes with annotated boundaries; 0 if there are none.
    double iou = 0.0;    ///< mean
    double exact = 0.0;  ///< share of ground truths
    Calibration calibration;
};
[[nodiscard]] FrontFigures front_figures(const SceneSet& set, const FrontWeights& weights,
                                         const FrontSearchOptions& search, unsigned threads);

struct FrontProgress {
    std::size_t step = 0;
    std::size_t steps = 0;
    enum class Stage { move_by_move, through_search, judging } stage = Stage::move_by_move;
    double loss = 0.0;                   ///< mean of a decision, since the last report
    double reached = 0.0;                ///< share of the scenes whose true lane the rules allow
    double kept = 0.0;                   ///< share of the scenes whose true lane the beam kept
    double found = 0.0;                  ///< share of the scenes whose answer is the true lane
    double risk = 0.0;                   ///< mean of the answers
    std::vector<FrontFigures> held_out;  ///< of each set held out
};

/// Learns the weights of `front` from courses: first each move of the true lane, then through the search,
/// then FrontJudge on the results of the search. The same courses, options (except `threads` and files) and
/// build give the same weights to the last bit, also if a run was stopped and resumed from its checkpoint.
/// Throws InvalidInput if an option is out of range, InputError if the checkpoint is of another training.
[[nodiscard]] FrontWeights train_front(const std::vector<Track>& courses,
                                       const std::vector<SceneSet>& held_out,
                                       const FrontTrainingOptions& options,
                                       const std::function<void(const FrontProgress&)>& report);

}  // namespace conelane::experiments
