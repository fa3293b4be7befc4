#include "experiments/files/parameter_file.hpp"

#include "experiments/files/atomic_file.hpp"
#include "experiments/files/json_node.hpp"
#include "experiments/files/known_keys.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace conelane::experiments {
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
    keys.insert(keys.end(), {"pairing", "use_confidence", "forbid_crossing"});
    return keys;
}

}  // namespace

RldParameters rld_parameters_of(const JsonNode& json) {
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
    json.require_valid([&] { validate(parameters); });
    return parameters;
}

RldParameters read_rld_parameters(const std::filesystem::path& file) {
    RldParameters parameters;
    with_json_file(file, [&](const JsonNode& json) { parameters = rld_parameters_of(json); });
    return parameters;
}

RldParameters parse_rld_parameters(std::string_view text, const std::filesystem::path& file) {
    RldParameters parameters;
    with_json_text(text, file, [&](const JsonNode& json) { parameters = rld_parameters_of(json); });
    return parameters;
}

void write_rld_parameters(const std::filesystem::path& file, const RldParameters& parameters) {
    validate(parameters);
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    for (const RldParameterField& field : rld_parameter_fields()) {
        json[std::string(field.key)] = parameters.*field.value;
    }
    json["pairing"] = to_string(parameters.pairing);
    // Extras stand in a file where they are on, or else not as they come.
    for (const RldParameterField& field : rld_extra_fields()) {
        if (parameters.*field.value != RldParameters{}.*field.value)
            json[std::string(field.key)] = parameters.*field.value;
    }
    if (parameters.use_confidence) json["use_confidence"] = 1;
    if (parameters.forbid_crossing) json["forbid_crossing"] = 1;
    AtomicFile output(file);
    output.stream() << json.dump(2) << '\n';
    output.commit();
}

}  // namespace conelane::experiments
