#include "experiments/studies/study.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace conelane::experiments {

std::string Shown::cell(const FieldValue& value) const {
    if (!value || value->is_null()) return "-";
    if (value->is_string()) return value->get<std::string>();
    if (as == As::fixed) return conelane::fixed(value->get<double>(), decimals);
    if (as == As::percent) return conelane::percent(value->get<double>(), decimals);
    return value->is_number_float() ? fmt::format("{:g}", value->get<double>()) : value->dump();
}

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
