#include "experiments/training/rld_training_run.hpp"

#include "evaluation/formats/provenance.hpp"
#include "evaluation/formats/track_spec.hpp"

#include <algorithm>
#include <iterator>
#include <memory>

#include <nlohmann/json.hpp>

namespace conelane::experiments {

RldTrainingRun run_rld_training(const RldTrainingRunOptions& options,
                                const std::function<void(const RldProgress&)>& report) {
    std::vector<Track> courses;
    for (const std::string& spec : options.tracks)
        std::ranges::move(load_tracks_aloud(spec), std::back_inserter(courses));
    std::erase_if(courses, [](const Track& track) { return track.left.empty() || track.right.empty(); });
    RldTrainingRun run;
    run.parameters = options.training.parameters;
    run.parameters.learned_costs =
        std::make_shared<const LearnedCosts>(train_rld(courses, options.training, report));
    auto record = nlohmann::ordered_json::parse(describe_training(courses, options.training));
    record["commit"] = provenance().commit;
    run.record = record.dump();
    return run;
}

}  // namespace conelane::experiments
