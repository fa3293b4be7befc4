#include "learning/training/training_run.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/formats/provenance.hpp"
#include "evaluation/formats/scene_set.hpp"
#include "evaluation/formats/track_spec.hpp"
#include "evaluation/formats/weights_file.hpp"
#include "evaluation/input_error.hpp"
#include "evaluation/seeded_random.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include <boost/random/uniform_real_distribution.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace conelane::learning {
namespace {

using Json = nlohmann::ordered_json;

Json track_names(const SceneSet& set) {
    Json names = Json::array();
    for (const auto& [name, boundaries] : set.tracks) names.push_back(name);
    return names;
}

template <typename Figures>
Json record_of(const Figures& figures) {
    Json record{{"scenes", figures.scenes}};
    for (const auto& [name, figure] : Figures::fields())
        record[name] = std::round(figures.*figure * 1e6) / 1e6;
    return record;
}

std::string line_of(const RankingFigures& figures) {
    return fmt::format(
        "usable {:.2f} % of at most {:.2f} %, mean IoU {:.2f} % of at most {:.2f} %, a candidate of 98 % in "
        "{:.1f} %, critical {:.2f} % of at least {:.2f} %",
        100.0 * figures.usable_share, 100.0 * figures.most_usable_share, 100.0 * figures.mean_iou,
        100.0 * figures.mean_best_iou, 100.0 * figures.near_best_share, 100.0 * figures.critical_share,
        100.0 * figures.least_critical_share);
}

std::string line_of(const StepScoreFigures& figures) {
    return fmt::format("right start {:.1f} %, right lane kept for 20 m {:.1f} %, whole {:.1f} %",
                       100.0 * figures.start_share, 100.0 * figures.near_kept_share,
                       100.0 * figures.kept_share);
}

/// Adds the figures and the commit to the record. Returns the figures as text.
template <typename Figures>
std::string finish(const Figures& trained, const Figures& held_out, Json& record) {
    record["figures_of_training"] = record_of(trained);
    record["figures_of_hold_out"] = record_of(held_out);
    record["commit"] = provenance().commit;
    std::string text;
    for (const auto& [of, figures] : {std::pair("training", &trained), std::pair("hold-out", &held_out)}) {
        if (figures->scenes > 0)
            text += fmt::format("{:<9} {:>6} scenes  {}\n", of, figures->scenes, line_of(*figures));
    }
    return text;
}

/// The scenes to train on, and the held-out ones, which may be empty.
std::pair<SceneSet, SceneSet> make_scene_sets(const LearnedScenes& options) {
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

Json parsed(const std::string& steps_record) {
    Json json = Json::parse(steps_record, nullptr, false);
    if (json.is_discarded()) throw InvalidInput("training", "is not JSON");
    return json;
}

}  // namespace

TrainingRun run_training(const TrainingRunOptions& options) {
    auto [set, held_out] = make_scene_sets(options);
    RankNetTrainingOptions training = options.training;
    Json record{{"tracks", track_names(set)},
                {"variants", options.variants},
                {"hold_out_tracks", track_names(held_out)},
                {"scenes", scene_options_json(options.scenes)},
                {"hold_out_every", options.hold_out_every_m},
                {"most_candidates_per_scene", options.candidates.max_per_scene},
                {"iterations", options.candidates.search.iteration_limit},
                {"steps", parsed(options.steps_record)},
                {"network", record_of(option_fields(training))}};
    add_variants(options, set);
    const std::vector<CandidateList> lists = enumerate_candidates(set, options.candidates);
    const RankNetWeights weights = train_rank_net(lists, options.training);
    const std::shared_ptr<const LaneRanking> ranking = make_rank_net(weights);
    CandidateListOptions all_candidates = options.candidates;
    all_candidates.max_per_scene = 0;
    TrainingRun run;
    run.summary = finish(ranking_figures(lists, *ranking),
                         ranking_figures(enumerate_candidates(held_out, all_candidates), *ranking), record);
    run.file = rank_net_json(weights, record.dump());
    return run;
}

TrainingRun run_step_training(const StepTrainingRunOptions& options) {
    const auto [set, held_out] = make_scene_sets(options);
    StepScoreTrainingOptions training = options.training;
    const StepScores scores = train_step_scores(set, training);
    Json record{{"tracks", track_names(set)},
                {"hold_out_tracks", track_names(held_out)},
                {"scenes", scene_options_json(options.scenes)},
                {"hold_out_every", options.hold_out_every_m},
                {"beam", record_of(option_fields(training))}};
    TrainingRun run;
    run.summary = finish(step_score_figures(set, scores, training.search),
                         step_score_figures(held_out, scores, training.search), record);
    run.file = step_scores_json(scores, record.dump());
    return run;
}

Track track_variant(Track track, std::size_t number, std::uint64_t seed) {
    constexpr double kMaxLogStretch = 0.15;
    track.name += fmt::format("_variant{}", number);
    track.frames.clear();  // a variant of a run is a course
    track.driven.clear();
    boost::random::mt19937_64 random = generator_of(track.name, seed);
    const double axis_rad = boost::random::uniform_real_distribution<double>(0.0, std::numbers::pi)(random);
    boost::random::uniform_real_distribution<double> log_stretch(-kMaxLogStretch, kMaxLogStretch);
    const double along = std::exp(log_stretch(random));
    const double across = std::exp(log_stretch(random));
    const Point axis(std::cos(axis_rad), std::sin(axis_rad));
    const Point normal(-axis.y(), axis.x());
    for (Cone& cone : track.cones) {
        cone.position = along * axis.dot(cone.position) * axis + across * normal.dot(cone.position) * normal;
    }
    if (number % 2 == 0) {
        std::swap(track.left, track.right);
        std::ranges::reverse(track.left);
        std::ranges::reverse(track.right);
    }
    return track;
}

}  // namespace conelane::learning
