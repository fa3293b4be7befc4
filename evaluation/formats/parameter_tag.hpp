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

}  // namespace conelane
