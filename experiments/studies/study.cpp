#include "experiments/studies/study.hpp"

#include "evaluation/formats/scene_file.hpp"

#include <filesystem>

#include <CLI/CLI.hpp>

namespace conelane::experiments {

void SceneStudy::add_options(CLI::App& command) {
    command
        .add_option("--scenes", scenes_, "*.scenes.jsonl; *.tracks.json beside it has the boundaries, if any")
        ->required();
}

StudyResult SceneStudy::run() {
    SceneSet set{read_scenes(scenes_), {}};
    const std::filesystem::path boundaries = track_boundaries_path(scenes_);
    if (std::filesystem::exists(boundaries)) set.tracks = read_track_boundaries(boundaries);
    return measure(set);
}

std::vector<std::unique_ptr<Study>> make_studies() {
    std::vector<std::unique_ptr<Study>> studies;
    for (const auto make : {make_optimality_study, make_backends_study, make_growth_study,
                            make_formulations_study, make_relaxations_study, make_front_beam_study})
        studies.push_back(make());
    return studies;
}

}  // namespace conelane::experiments
