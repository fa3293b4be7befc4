#pragma once

#include "conelane/rld_parameters.hpp"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

namespace conelane {

/// The parameters of a claim, so that the claim is not checked with others. Files of earlier versions and of
/// other programs may lack parts of it.
struct ParameterTag {
    std::optional<std::string> name;  ///< for people: a shipped set, a file, or `default` without --params
    std::optional<std::string> hash;  ///< of all parameters but the pairing, 16 hexadecimal digits
    std::optional<Pairing> pairing;

    bool operator==(const ParameterTag&) const = default;
};

/// `source`: the argument of --params, or empty. For a file, the tag holds the name without the
/// folder.
[[nodiscard]] ParameterTag tag_of(const std::string& source, const RldParameters& parameters);

/// How a claim was made, or how it is checked.
struct ClaimBasis {
    ParameterTag parameters;
    std::optional<std::size_t> nearest;  ///< size of the cone set
};

/// Throws InputError naming file, line and key if the claim of that line was made with other parameters,
/// another pairing or another cone set than `checked` says. A value that one of the two lacks is no
/// difference, but a claim with a tag and without a size was made among all cones.
void require_same_basis(const ClaimBasis& made, const ClaimBasis& checked, const std::filesystem::path& file,
                        std::size_t line);

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
