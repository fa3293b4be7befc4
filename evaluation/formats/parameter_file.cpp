#include "evaluation/formats/parameter_file.hpp"

#include "detectors/parameters/learned_costs_reader.hpp"
#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/json_node.hpp"
#include "evaluation/formats/weights_file.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace conelane {
namespace {

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
