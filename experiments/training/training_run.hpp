#pragma once

#include "evaluation/world/scene_generation.hpp"
#include "experiments/training/candidate_lists.hpp"
#include "experiments/training/rank_net_training.hpp"
#include "experiments/training/step_score_training.hpp"
#include "graph_search/clc/ranking.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace conelane::experiments {

struct TrainingRunOptions {
    std::vector<std::string> tracks;    ///< SPECs of load_tracks
    std::size_t variants = 0;           ///< of each track, trained on beside itself
    std::vector<std::string> hold_out;  ///< the same; never trained on, only measured
    SceneOptions scenes;
    double hold_out_every_m = 10.0;  ///< travel between poses there: all candidates of a scene are scored
    CandidateListOptions candidates;
    std::string steps_record = "null";  ///< of the training of candidates.search.step_scores; JSON
    RankNetTrainingOptions training;
};

struct TrainingRun {
    RankNetWeights weights;
    RankingFigures trained;   ///< on the lists of the training
    RankingFigures held_out;  ///< on all candidates of the hold-out scenes; all zero if there are none
    std::string record;  ///< JSON object: everything that determines the result, both figures, the commit
};

/// From track names to a trained network and the record of its training. The record names tracks, not files.
/// Throws InputError or InvalidInput; also if a track is both trained on and held out.
[[nodiscard]] TrainingRun run_training(const TrainingRunOptions& options);

struct StepTrainingRunOptions {
    std::vector<std::string> tracks;    ///< SPECs of load_tracks
    std::vector<std::string> hold_out;  ///< the same; never trained on, only measured
    SceneOptions scenes;
    double hold_out_every_m = 10.0;
    StepScoreTrainingOptions training;
};

struct StepTrainingRun {
    StepScores scores;
    StepScoreFigures trained;
    StepScoreFigures held_out;  ///< all zero where there are none
    std::string record;         ///< as that of TrainingRun
};

/// The same for the scores of the beam search.
[[nodiscard]] StepTrainingRun run_step_training(const StepTrainingRunOptions& options);

}  // namespace conelane::experiments
