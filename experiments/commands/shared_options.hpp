#pragma once

#include "experiments/scenes/annotated_scene.hpp"
#include "experiments/scenes/scene_generation.hpp"
#include "model/rld_parameters.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

/// Options that several commands have, declared once.
namespace conelane::experiments {

/// The options of scene making but --tracks, --out and --nearest. Absent lists keep what `options` holds.
void add_scene_options(CLI::App& command, SceneOptions& options);

/// --params and --pairing.
struct ParameterSource {
    std::string file;     ///< empty: the shipped default
    std::string pairing;  ///< empty: as in the file
    [[nodiscard]] RldParameters load() const;
};
void add_parameter_options(CLI::App& command, ParameterSource& source);

/// --nearest N
void add_nearest_option(CLI::App& command, std::optional<std::size_t>& nearest, const std::string& meaning);
/// --time-limit MS
void add_time_limit_option(CLI::App& command, double& time_limit_ms);
/// --threads T
void add_threads_option(CLI::App& command, unsigned& threads, const std::string& meaning);

}  // namespace conelane::experiments
