#pragma once

#include "conelane/rld_parameters.hpp"

#include <filesystem>
#include <string_view>

namespace conelane {

/// RLD parameters from a flat JSON object. Every numeric key of the paper is required. If absent, `pairing`
/// is near_far, the extras `use_confidence` and `forbid_crossing` (0 or 1) are off, and those of
/// rld_extra_fields() have their defaults. `learned_costs` names a file that `conelane train rld` wrote,
/// relative to the folder of the parameters. Throws InputError naming file and key, also for an unknown key,
/// or the line that is not JSON.
[[nodiscard]] RldParameters read_rld_parameters(const std::filesystem::path& file);

class JsonNode;
/// The same from an object inside a file of that folder.
[[nodiscard]] RldParameters rld_parameters_of(const JsonNode& json, const std::filesystem::path& folder = {});

/// Learned costs are written to a file of their own beside it, FILE.weights.json for FILE.json, with the JSON
/// object `training` as their record. Throws InvalidInput if a parameter is invalid, InputError if a file
/// cannot be written; an old file then stays unchanged.
void write_rld_parameters(const std::filesystem::path& file, const RldParameters& parameters,
                          std::string_view training = "{}");

}  // namespace conelane
