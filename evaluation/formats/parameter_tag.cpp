#include "evaluation/formats/parameter_tag.hpp"

#include "conelane/learned_costs.hpp"
#include "evaluation/input_error.hpp"

#include <cstdint>
#include <string_view>

#include <fmt/format.h>

namespace conelane {
namespace {

constexpr const char* kDefault = "default";

/// FNV-1a of "key=value;" for each parameter of the paper, and for each extra that differs from its default:
/// so a new extra changes no hash.
std::string hash_of(const RldParameters& parameters) {
    std::uint64_t hash = 14695981039346656037U;
    const auto add = [&](std::string_view key, double value) {
        for (const char c : fmt::format("{}={};", key, value)) {
            hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211U;
        }
    };
    for (const RldParameterField& field : rld_parameter_fields()) add(field.key, parameters.*field.value);
    for (const RldParameterField& field : rld_extra_fields()) {
        if (parameters.*field.value != RldParameters{}.*field.value) add(field.key, parameters.*field.value);
    }
    if (parameters.use_confidence) add("use_confidence", 1.0);
    if (parameters.forbid_crossing) add("forbid_crossing", 1.0);
    if (parameters.learned_costs) {
        for (const LearnedPart part : kLearnedParts) {
            const LearnedNetwork& network = parameters.learned_costs->of(part);
            for (const auto* list : {&network.linear, &network.hidden, &network.output}) {
                for (const double weight : *list) add(to_string(part), weight);
            }
        }
    }
    return fmt::format("{:016x}", hash);
}

std::string cones_text(std::optional<std::size_t> nearest) {
    return nearest ? fmt::format("the {} nearest cones", *nearest) : "all cones";
}

std::string parameters_fault(const ParameterTag& made, const ParameterTag& checked) {
    const std::string made_by = made.name.value_or("others");
    if (made.name == checked.name) return fmt::format("made by other values than '{}' has now", made_by);
    const std::string advice = made_by == kDefault ? "leave out --params" : "give --params " + made_by;
    return fmt::format("made by '{}', checked by '{}': {}", made_by, checked.name.value_or("others"),
                       made.name ? advice : "give the same --params");
}

}  // namespace

ParameterTag tag_of(const std::string& source, const RldParameters& parameters) {
    // The tag holds the file's name without its folder.
    const std::string name = source.empty() ? kDefault : std::filesystem::path(source).filename().string();
    return {name, hash_of(parameters), parameters.pairing};
}

void require_same_basis(const ClaimBasis& made, const ClaimBasis& checked, const std::filesystem::path& file,
                        std::size_t line) {
    const ParameterTag& tag = made.parameters;
    if (tag.hash && checked.parameters.hash && tag.hash != checked.parameters.hash)
        throw InputError(file, line, "parameters", parameters_fault(tag, checked.parameters));
    if (tag.pairing && checked.parameters.pairing && tag.pairing != checked.parameters.pairing) {
        throw InputError(
            file, line, "pairing",
            fmt::format("made by '{}', checked by '{}': give --pairing {}", to_string(*tag.pairing),
                        to_string(*checked.parameters.pairing), to_string(*tag.pairing)));
    }
    const bool says_cones = made.nearest || tag.hash;
    if (says_cones && checked.nearest && made.nearest != checked.nearest) {
        throw InputError(file, line, "nearest",
                         fmt::format("made among {}, checked among {}: leave out --nearest",
                                     cones_text(made.nearest), cones_text(checked.nearest)));
    }
}

}  // namespace conelane
