#pragma once

#include "experiments/studies/study.hpp"

#include <CLI/CLI.hpp>

namespace conelane::experiments {

/// What the study of this name measures, with options as on the command line: on these scenes instead of
/// those of a file if it is a study of scenes.
inline StudyResult measured(const std::string& name, const std::string& options, const SceneSet& set = {}) {
    for (const std::unique_ptr<Study>& study : make_studies()) {
        if (study->description().name != name) continue;
        auto* const of_scenes = dynamic_cast<SceneStudy*>(study.get());
        CLI::App app;
        study->add_options(app);
        app.parse(options + (of_scenes != nullptr ? " --scenes none" : ""));
        return of_scenes != nullptr ? of_scenes->measure(set) : study->run();
    }
    throw std::invalid_argument("there is no study " + name);
}

}  // namespace conelane::experiments
