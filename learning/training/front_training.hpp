#pragma once

#include "evaluation/formats/scene_set.hpp"
#include "evaluation/scoring/calibration.hpp"
#include "learning/training/front_judge_learner.hpp"
#include "learning/training/front_scenes.hpp"

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace conelane::learning {

/// Most are explained by option_fields.
struct FrontTrainingOptions : DrawnTrainingOptions {
    FrontTrainingOptions() { report_every = 1000; }
    FrontLossOptions loss;
    /// Weights with which the training begins, instead of random ones, and their name in the record.
    std::optional<FrontWeights> initial;
    std::string initial_name;
    /// FrontWeights::colored begins with that of `initial`, or with its first set if it has none.
    bool only_colors = false;
    std::vector<std::string> without;
    std::size_t imitation_steps = 800;  ///< of teacher forcing
    std::size_t search_steps = 7000;    ///< through the search, after these
    std::size_t judge_steps = 4000;     ///< of FrontJudge, after these
    /// `usable` is no input of the other networks of the judge, so without `rank` and `right` the order of
    /// the lanes does not change.
    std::vector<std::string> judge_parts{"rank", "usable", "right"};
    double imitation_rate = 3e-3;  ///< learning rates of Adam, which fall to 0 along a cosine
    double search_rate = 1e-3;
    double judge_rate = 2e-3;
    double trusted = 0.995;
    std::size_t trust_draws = 1000;
    /// These are drawn from the following courses, or from those that are learned from.
    std::vector<Track> trust_courses;
};
/// Those of the record, which determine the weights together with the courses, and how it is run.
[[nodiscard]] OptionFields option_fields(FrontTrainingOptions& options);

/// Throws InvalidInput naming the option that is out of its range.
void validate(const FrontTrainingOptions& options);

/// Everything that determines the weights, as one line of JSON.
[[nodiscard]] std::string describe_training(const std::vector<Track>& courses,
                                            const FrontTrainingOptions& options);

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

/// What a training says of its steps since it last said something, and its figures then of each set held out.
using FrontReport = std::function<void(const std::string& line, const std::vector<FrontFigures>& held_out)>;

/// Learns the weights of `front` from courses: first each move of the true lane, then through the search,
/// then FrontJudge on the results of the search. The same courses, options (except run_fields) and build give
/// the same weights to the last bit, also if a run was stopped and resumed from its checkpoint. Throws
/// InvalidInput if an option is out of range, InputError if the checkpoint is of another training.
[[nodiscard]] FrontWeights train_front(const std::vector<Track>& courses,
                                       const std::vector<SceneSet>& held_out,
                                       const FrontTrainingOptions& options, const FrontReport& report);

struct FrontTrainingRunOptions {
    std::vector<std::string> tracks;    ///< SPECs of load_tracks
    std::vector<std::string> hold_out;  ///< the same; never trained on, only measured
    /// The same; least_trust is chosen on them. Never trained on. Empty: it is chosen on the tracks trained
    /// on.
    std::vector<std::string> trust_tracks;
    double hold_out_every_m = 10.0;
    std::vector<std::string> conditions{"paper", "car"};  ///< a set of held-out scenes each
    std::vector<double> rates{0.0, 0.1, 0.3, 0.5};        ///< of these scenes
    FrontTrainingOptions training;
};
struct FrontTrainingRun {
    FrontWeights weights;
    std::string record;  ///< JSON object: everything that determines the result, the last figures, the commit
};
/// From track names to weights and the record of their training. The record names tracks, not files. Runs
/// without annotated boundaries are left out. `say` gets lines of text. Throws InputError or InvalidInput;
/// also if a track is both trained on and held out.
[[nodiscard]] FrontTrainingRun run_front_training(const FrontTrainingRunOptions& options,
                                                  const std::function<void(const std::string&)>& say);

}  // namespace conelane::learning
