#include "experiments/files/parameter_file.hpp"

#include "experiments/files/atomic_file.hpp"
#include "experiments/files/json_node.hpp"

#include <array>
#include <string>

namespace conelane::experiments {
namespace {

constexpr std::array kPairings{Pairing::near_far, Pairing::paper};

RldParameters rld_parameters_of(const JsonNode& json) {
    RldParameters parameters;
    for (const RldParameterField& field : rld_parameter_fields()) {
        parameters.*field.value = json.member(field.key).number();
    }
    if (const auto pairing = json.find("pairing")) parameters.pairing = pairing->one_of(kPairings);
    json.require_valid([&] { validate(parameters); });
    return parameters;
}

}  // namespace

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
    AtomicFile output(file);
    output.stream() << json.dump(2) << '\n';
    output.commit();
}

}  // namespace conelane::experiments
