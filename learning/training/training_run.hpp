#pragma once

#include "evaluation/world/scene_generation.hpp"
#include "learning/training/candidate_lists.hpp"
#include "learning/training/rank_net_training.hpp"
#include "learning/training/step_score_training.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace conelane::learning {

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
