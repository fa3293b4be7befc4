#include "experiments/training/training_run.hpp"

#include "evaluation/formats/provenance.hpp"
#include "evaluation/formats/scene_options_json.hpp"
#include "evaluation/formats/scene_set.hpp"
#include "evaluation/formats/track_spec.hpp"
#include "evaluation/input_error.hpp"
#include "experiments/training/track_variant.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <nlohmann/json.hpp>

namespace conelane::experiments {
namespace {

using Json = nlohmann::ordered_json;

Json track_names(const SceneSet& set) {
    Json names = Json::array();
    for (const auto& [name, boundaries] : set.tracks) names.push_back(name);
    return names;
}

double rounded(double value) {
    return std::round(value * 1e6) / 1e6;
}

Json describe(const RankingFigures& figures) {
    return {{"scenes", figures.scenes},
            {"mean_iou", rounded(figures.mean_iou)},
            {"mean_best_iou", rounded(figures.mean_best_iou)},
            {"near_best_share", rounded(figures.near_best_share)},
            {"usable_share", rounded(figures.usable_share)},
            {"most_usable_share", rounded(figures.most_usable_share)},
            {"critical_share", rounded(figures.critical_share)},
            {"least_critical_share", rounded(figures.least_critical_share)}};
}

Json describe(const RankNetTrainingOptions& training) {
    return {{"units", training.units},
            {"loss", training.loss == RankLoss::pairs ? "pairs" : "choice"},
            {"epochs", training.epochs},
            {"pairs_a_step", training.pairs_a_step},
            {"scenes_a_step", training.scenes_a_step},
            {"learning_rate", training.learning_rate},
            {"weight_decay", training.weight_decay},
            {"iou_factor", training.iou_factor},
            {"divergence_penalty", training.divergence_penalty},
            {"late_divergence_penalty", training.late_divergence_penalty},
            {"unusable_penalty", training.unusable_penalty},
            {"leader_share", training.leader_share},
            {"seed", training.seed}};
}

Json describe(const StepScoreFigures& figures) {
    return {{"scenes", figures.scenes},
            {"start_share", rounded(figures.start_share)},
            {"near_kept_share", rounded(figures.near_kept_share)},
            {"kept_share", rounded(figures.kept_share)}};
}

/// The scenes to train on, and the held-out ones, which may be empty.
template <typename Options>
std::pair<SceneSet, SceneSet> make_scene_sets(const Options& options) {
    std::pair<SceneSet, SceneSet> sets{make_scene_set(options.tracks, options.scenes), {}};
    SceneOptions hold_out_scenes = options.scenes;
    hold_out_scenes.every_m = options.hold_out_every_m;
    if (!options.hold_out.empty()) sets.second = make_scene_set(options.hold_out, hold_out_scenes);
    for (const auto& [name, boundaries] : sets.second.tracks) {
        if (sets.first.tracks.contains(name)) {
            throw InputError("", 0, "--hold-out", "track '" + name + "' is trained on");
        }
    }
    return sets;
}

void add_variants(const TrainingRunOptions& options, SceneSet& set) {
    for (const std::string& spec : options.tracks) {
        for (const Track& track : load_tracks(spec)) {
            if (!track.frames.empty()) continue;  // the maps of a run stay as they were recorded
            for (std::size_t number = 1; number <= options.variants; ++number) {
                const Track variant = track_variant(track, number, options.scenes.seed);
                set.tracks.emplace(variant.name, boundaries(variant));
                std::ranges::move(generate_scenes(variant, options.scenes), std::back_inserter(set.scenes));
            }
        }
    }
}

}  // namespace

TrainingRun run_training(const TrainingRunOptions& options) {
    auto [set, held_out] = make_scene_sets(options);
    const Json trained_on = track_names(set);
    add_variants(options, set);
    const std::vector<CandidateList> lists = enumerate_candidates(set, options.candidates);
    TrainingRun run;
    run.weights = train_rank_net(lists, options.training);
    const std::shared_ptr<const LaneRanking> ranking = make_rank_net(run.weights);
    run.trained = ranking_figures(lists, *ranking);
    CandidateListOptions all_candidates = options.candidates;
    all_candidates.max_per_scene = 0;
    run.held_out = ranking_figures(enumerate_candidates(held_out, all_candidates), *ranking);

    const Json record{{"tracks", trained_on},
                      {"variants", options.variants},
                      {"hold_out_tracks", track_names(held_out)},
                      {"scenes", scene_options_json(options.scenes)},
                      {"hold_out_every", options.hold_out_every_m},
                      {"most_candidates_per_scene", options.candidates.max_per_scene},
                      {"iterations", options.candidates.search.iteration_limit},
                      {"steps", Json::parse(options.steps_record)},
                      {"network", describe(options.training)},
                      {"figures_of_training", describe(run.trained)},
                      {"figures_of_hold_out", describe(run.held_out)},
                      {"commit", provenance().commit}};
    run.record = record.dump();
    return run;
}

StepTrainingRun run_step_training(const StepTrainingRunOptions& options) {
    const auto [set, held_out] = make_scene_sets(options);
    StepTrainingRun run;
    run.scores = train_step_scores(set, options.training);
    run.trained = step_score_figures(set, run.scores, options.training.search);
    run.held_out = step_score_figures(held_out, run.scores, options.training.search);
    const Json record{{"tracks", track_names(set)},
                      {"hold_out_tracks", track_names(held_out)},
                      {"scenes", scene_options_json(options.scenes)},
                      {"hold_out_every", options.hold_out_every_m},
                      {"beam",
                       {{"width", options.training.search.beam_width},
                        {"epochs", options.training.epochs},
                        {"learning_rate", options.training.learning_rate},
                        {"weight_decay", options.training.weight_decay},
                        {"seed", options.training.seed}}},
                      {"figures_of_training", describe(run.trained)},
                      {"figures_of_hold_out", describe(run.held_out)},
                      {"commit", provenance().commit}};
    run.record = record.dump();
    return run;
}

}  // namespace conelane::experiments
