#include "experiments/training/front_training_run.hpp"

#include "evaluation/formats/provenance.hpp"
#include "evaluation/formats/track_spec.hpp"
#include "evaluation/input_error.hpp"
#include "experiments/training/front_checkpoint.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <nlohmann/json.hpp>

namespace conelane::experiments {
namespace {

using Json = nlohmann::ordered_json;

double rounded(double value) {
    return std::round(value * 1e6) / 1e6;
}

Json describe(const FrontFigures& figures) {
    return {{"scenes", figures.scenes},
            {"usable", rounded(figures.usable)},
            {"iou", rounded(figures.iou)},
            {"exact", rounded(figures.exact)},
            {"calibration_error", rounded(figures.calibration.error().value_or(0.0))},
            {"usable_where_sure", rounded(figures.calibration.usable_where_sure().value_or(0.0))},
            {"trusted", rounded(figures.calibration.trusted_share().value_or(0.0))},
            {"right_where_trusted", rounded(figures.calibration.right_where_trusted().value_or(0.0))}};
}

/// Without tracks that have no annotated boundaries.
std::vector<Track> annotated_tracks(const std::vector<std::string>& specs) {
    std::vector<Track> tracks;
    for (const std::string& spec : specs)
        std::ranges::move(load_tracks_aloud(spec), std::back_inserter(tracks));
    std::erase_if(tracks, [](const Track& track) { return track.left.empty() || track.right.empty(); });
    return tracks;
}

void require_not_trained_on(const std::string& name, const std::vector<Track>& courses, const char* option) {
    if (std::ranges::find(courses, name, &Track::name) != courses.end())
        throw InputError("", 0, option, "track '" + name + "' is trained on");
}

}  // namespace

FrontTrainingRun run_front_training(const FrontTrainingRunOptions& options,
                                    const std::function<void(const FrontProgress&)>& report) {
    const std::vector<Track> courses = annotated_tracks(options.tracks);
    FrontTrainingOptions training = options.training;
    training.trust_courses = annotated_tracks(options.trust_tracks);
    for (const Track& track : training.trust_courses)
        require_not_trained_on(track.name, courses, "--trust-tracks");
    std::vector<SceneSet> held_out;
    if (!options.hold_out.empty()) {
        for (const std::string& condition : options.conditions) {
            SceneOptions scenes;
            scenes.conditions = {condition};
            scenes.false_positive_rates = options.rates;
            scenes.ranges_m = {30.0, 50.0};
            scenes.every_m = options.hold_out_every_m;
            scenes.threads = options.training.threads;
            held_out.push_back(make_scene_set(options.hold_out, scenes));
        }
    }
    Json held_out_names = Json::array();
    if (!held_out.empty()) {
        for (const auto& [name, boundaries] : held_out.front().tracks) {
            held_out_names.push_back(name);
            require_not_trained_on(name, courses, "--hold-out");
        }
    }
    FrontTrainingRun run;
    std::vector<FrontFigures> last;
    run.weights = train_front(courses, held_out, training, [&](const FrontProgress& progress) {
        last = progress.held_out;
        if (report) report(progress);
    });
    Json record = Json::parse(describe_training(courses, training));
    record["hold_out_tracks"] = held_out_names;
    record["hold_out_every"] = options.hold_out_every_m;
    Json figures = Json::object();
    for (std::size_t i = 0; i < last.size(); ++i) figures[options.conditions[i]] = describe(last[i]);
    record["figures_of_hold_out"] = figures;
    record["commit"] = provenance().commit;
    run.record = record.dump();
    return run;
}

}  // namespace conelane::experiments
