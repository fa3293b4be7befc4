#pragma once

#include "experiments/options/shared_options.hpp"
#include "experiments/studies/cone_sets.hpp"

#include <cstddef>
#include <string>
#include <vector>

/// Command-line options that several studies have, declared once.
namespace conelane::experiments {

/// The scenes and parameters of a study.
struct StudyInput {
    std::string scenes;  ///< a file
    ParameterSource parameters;
};
/// --scenes, --params and --pairing
void add_input_options(CLI::App& command, StudyInput& input);

/// --sizes; what `sizes` holds is the default.
void add_sizes_option(CLI::App& command, std::vector<std::size_t>& sizes);

/// --sizes, --limit and --time-limit; what `options` holds is the default.
void add_cone_set_options(CLI::App& command, ConeSetOptions& options);

}  // namespace conelane::experiments
