#pragma once

#include "learning/training/rank_net_training.hpp"

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

/// What the trainings of `clc` learn from.
struct LearnedScenes {
    std::vector<std::string> tracks;    ///< SPECs of load_tracks
    std::vector<std::string> hold_out;  ///< the same; never trained on, only measured
    SceneOptions scenes;
    double hold_out_every_m = 10.0;  ///< travel between poses there: all candidates of a scene are scored
};

struct TrainingRunOptions : LearnedScenes {
    std::size_t variants = 0;  ///< of each track, trained on beside itself
    CandidateListOptions candidates;
    std::string steps_record = "null";  ///< of the training of candidates.search.step_scores; JSON
    RankNetTrainingOptions training;
};

struct StepTrainingRunOptions : LearnedScenes {
    StepScoreTrainingOptions training;
};

struct TrainingRun {
    /// The file of weights. Its `training` has everything that determines the weights, the figures on the
    /// scenes of the training and on those held out, which are all zero if there are none, and the commit.
    std::string file;
    std::string summary;  ///< these figures in lines of text
};

/// From track names to a trained network. The record names tracks, not files. Throws InputError or
/// InvalidInput; also if a track is both trained on and held out.
[[nodiscard]] TrainingRun run_training(const TrainingRunOptions& options);
/// The same for the scores of the beam search.
[[nodiscard]] TrainingRun run_step_training(const StepTrainingRunOptions& options);

/// A variant of a track, so that lanes are learned instead of tracks: stretched along an axis and across it,
/// with a random axis and random factors up to exp(0.15) = 1.16 either way; every second variant is driven in
/// the other direction. `number`, from 1, is part of the name and, with the name and the seed, determines the
/// draws.
[[nodiscard]] Track track_variant(Track track, std::size_t number, std::uint64_t seed);

}  // namespace conelane::learning
