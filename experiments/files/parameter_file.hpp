#pragma once

#include "conelane/rld_parameters.hpp"

#include <filesystem>
#include <string_view>

namespace conelane::experiments {

/// RLD parameters from a flat JSON object. Every numeric key of the paper is required; `pairing` is near_far
/// where absent, the extras `use_confidence` and `forbid_crossing` (0 or 1) are off and those of
/// rld_extra_fields() have their defaults.
/// Throws InputError naming file and key, also one that is no parameter, and the line of what is no JSON.
[[nodiscard]] RldParameters read_rld_parameters(const std::filesystem::path& file);

/// The same from a text; errors name `file`.
[[nodiscard]] RldParameters parse_rld_parameters(std::string_view text, const std::filesystem::path& file);

class JsonNode;
/// The same from an object inside a file.
[[nodiscard]] RldParameters rld_parameters_of(const JsonNode& json);

/// Throws InvalidInput where a parameter is not valid, InputError where the file cannot be written; then an
/// old file stays as it was.
void write_rld_parameters(const std::filesystem::path& file, const RldParameters& parameters);

}  // namespace conelane::experiments
