#include "evaluation/formats/parameter_file.hpp"

#include "detectors/parameters/learned_costs_reader.hpp"
#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/file_text.hpp"
#include "evaluation/formats/json_node.hpp"
#include "evaluation/formats/weights_file.hpp"
#include "evaluation/input_error.hpp"

#include <fmt/format.h>

namespace conelane {
namespace {

constexpr const char* kDefault = "default";

/// FNV-1a of "key=value;" for each parameter of the paper, and for each extra that differs from its default:
/// so a new extra changes no hash.
std::string hash_of(const RldParameters& parameters) {
    std::string text;
    const auto add = [&](std::string_view key, double value) { text += fmt::format("{}={};", key, value); };
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
    return text_hash(text);
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

constexpr std::array kPairings{Pairing::near_far, Pairing::paper};

/// 0 or 1.
bool is_on(const JsonNode& flag) {
    const std::int64_t value = flag.integer();
    if (value != 0 && value != 1) flag.fail("must be 0 or 1");
    return value == 1;
}

std::vector<std::string_view> all_keys() {
    std::vector<std::string_view> keys;
    for (const auto fields : {rld_parameter_fields(), rld_extra_fields()}) {
        for (const RldParameterField& field : fields) keys.push_back(field.key);
    }
    keys.insert(keys.end(), {"pairing", "use_confidence", "forbid_crossing", "learned_costs"});
    return keys;
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

RldParameters rld_parameters_of(const JsonNode& json, const std::filesystem::path& folder) {
    static const std::vector<std::string_view> kKeys = all_keys();
    RldParameters parameters;
    for (const RldParameterField& field : rld_parameter_fields()) {
        parameters.*field.value = json.member(field.key).number();
    }
    if (const auto pairing = json.find("pairing")) parameters.pairing = pairing->one_of(kPairings);
    for (const RldParameterField& field : rld_extra_fields()) {
        if (const auto value = json.find(field.key)) parameters.*field.value = value->number();
    }
    if (const auto flag = json.find("use_confidence")) parameters.use_confidence = is_on(*flag);
    if (const auto flag = json.find("forbid_crossing")) parameters.forbid_crossing = is_on(*flag);
    require_known_keys(json, kKeys);
    if (const auto file = json.find("learned_costs")) {
        try {
            parameters.learned_costs = read_learned_costs(folder / file->string());
        } catch (const InvalidInput& error) {
            file->fail(error.what());
        }
    }
    json.require_valid([&] { validate(parameters); });
    return parameters;
}

RldParameters read_rld_parameters(const std::filesystem::path& file) {
    RldParameters parameters;
    with_json_file(file,
                   [&](const JsonNode& json) { parameters = rld_parameters_of(json, file.parent_path()); });
    return parameters;
}

void write_rld_parameters(const std::filesystem::path& file, const RldParameters& parameters,
                          std::string_view training) {
    validate(parameters);
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    for (const RldParameterField& field : rld_parameter_fields()) {
        json[std::string(field.key)] = parameters.*field.value;
    }
    json["pairing"] = to_string(parameters.pairing);
    // Extras are written only if they differ from their defaults.
    for (const RldParameterField& field : rld_extra_fields()) {
        if (parameters.*field.value != RldParameters{}.*field.value)
            json[std::string(field.key)] = parameters.*field.value;
    }
    if (parameters.use_confidence) json["use_confidence"] = 1;
    if (parameters.forbid_crossing) json["forbid_crossing"] = 1;
    if (parameters.learned_costs) {
        std::filesystem::path weights = file;
        weights.replace_extension(".weights.json");
        json["learned_costs"] = weights.filename().string();
        AtomicFile of_weights(weights);
        of_weights.stream() << learned_costs_json(*parameters.learned_costs, training);
        of_weights.commit();
    }
    AtomicFile output(file);
    output.stream() << json.dump(2) << '\n';
    output.commit();
}

}  // namespace conelane
