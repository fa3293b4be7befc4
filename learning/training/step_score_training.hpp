#pragma once

#include "evaluation/formats/scene_set.hpp"
#include "graph_search/clc/candidate_search.hpp"
#include "graph_search/clc/lane_beam.hpp"
#include "learning/training/option_field.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace conelane::learning {

struct StepScoreTrainingOptions {
    CandidateSearchOptions
        search;                   ///< its graph, starts, bounds and beam_width are used; the rest is ignored
    std::size_t epochs = 3;       ///< in each, every scene is met once
    double learning_rate = 0.05;  ///< of Adam, a step a scene; falls to 0 along a cosine
    double weight_decay = 1.0;    ///< of a score by each step, times the learning rate
    std::uint64_t seed = 0;
    bool show_progress = true;
};
[[nodiscard]] OptionFields option_fields(StepScoreTrainingOptions& options);

/// Learns the scores that keep the right lane in the beam (learning as search optimisation). The ground truth
/// grows beside the beam. On each level, and once more where it ends and all others go on, the loss is minus
/// the logarithm of its probability under softmax(scores) of the level; if it has dropped out, the beam
/// continues from it. The same scenes, options and build give the same scores to the last bit; runs on one
/// thread. Throws InvalidInput if no scene has a ground truth that a beam may start with, or an option is out
/// of range.
[[nodiscard]] StepScores train_step_scores(const SceneSet& set, const StepScoreTrainingOptions& options);

/// How often a beam keeps the right lane.
struct StepScoreFigures {
    std::size_t scenes = 0;        ///< those that count
    double start_share = 0.0;      ///< scenes whose right pair is one to start from
    double near_kept_share = 0.0;  ///< right lane on each level up to kNearPart_m on both sides
    double kept_share = 0.0;       ///< up to its end

    static constexpr auto fields() {
        using Figures = StepScoreFigures;
        return std::array{std::pair{"start_share", &Figures::start_share},
                          std::pair{"near_kept_share", &Figures::near_kept_share},
                          std::pair{"kept_share", &Figures::kept_share}};
    }
};
/// All zero without scenes.
[[nodiscard]] StepScoreFigures step_score_figures(const SceneSet& set, const StepScores& scores,
                                                  const CandidateSearchOptions& search);

}  // namespace conelane::learning
