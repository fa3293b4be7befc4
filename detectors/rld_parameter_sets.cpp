#include "conelane/rld_parameter_sets.hpp"

#include "conelane/invalid_input.hpp"
#include "detectors/parameters/learned_costs_reader.hpp"
#include "detectors/recipe.hpp"
#include "graph_search/shared/json_reader.hpp"
#include "graph_search/shared/weights_reader.hpp"

namespace conelane {
namespace {

struct ParameterSet {
    std::string_view name;
    RldParameters parameters;
};

RldParameters parameters_of(std::string_view file) {
    std::vector<RldParameterField> fields(rld_parameter_fields().begin(), rld_parameter_fields().end());
    fields.insert(fields.end(), rld_extra_fields().begin(), rld_extra_fields().end());
    RldParameters parameters;
    std::set<std::string, std::less<>> keys;
    JsonReader json(file, "parameters");
    json.object([&](const std::string& key) {
        if (!keys.insert(key).second) throw InvalidInput(key, "is there twice");
        const auto field = std::ranges::find(fields, key, &RldParameterField::key);
        if (field != fields.end()) {
            parameters.*field->value = json.number();
        } else if (key == "learned_costs") {  // the only embedded weights file
            json.skip();
            parameters.learned_costs = parse_learned_costs(kLearnedWeightsFile);
        } else if (key == "pairing") {
            const std::string pairing = json.string();
            if (pairing != to_string(Pairing::paper) && pairing != to_string(Pairing::near_far))
                throw InvalidInput(key, "is not a pairing");
            parameters.pairing = pairing == to_string(Pairing::paper) ? Pairing::paper : Pairing::near_far;
        } else {
            throw InvalidInput(key, "is not a parameter");
        }
    });
    json.require_end();
    for (const RldParameterField& field : rld_parameter_fields()) {
        if (!keys.contains(field.key)) throw InvalidInput(std::string(field.key), "is missing");
    }
    if (!keys.contains("pairing")) throw InvalidInput("pairing", "is missing");
    validate(parameters);
    return parameters;
}

const std::vector<ParameterSet>& parameter_sets() {
    static const std::vector<ParameterSet> kSets = [] {
        std::vector<ParameterSet> sets;
        for (const std::string_view name : {"n12", "context", "shape", "full", "learned"})
            sets.push_back({name, parameters_of(parameter_file(name))});
        return sets;
    }();
    return kSets;
}

template <typename Costs>
std::shared_ptr<const Costs> parse_costs(std::string_view text, std::string_view command,
                                         std::string_view of) {
    WeightsReader file(text, "weights", command);
    (void)file.version({1});
    for (const auto part : Costs::kParts)
        file.require_features("features." + std::string(to_string(part)), learned_features(part));
    Costs costs;
    for_each_costs_list(
        costs, [&](const std::string& key, std::vector<double>& numbers) { numbers = file.numbers(key); });
    file.require_no_other(of);
    validate(costs);
    return std::make_shared<const Costs>(std::move(costs));
}

template <typename Parse>
auto read_costs(const std::filesystem::path& file, const Parse& parse) {
    decltype(parse({})) costs;
    with_weights_file(file, [&](std::string_view text) { costs = parse(text); });
    return costs;
}

}  // namespace

std::shared_ptr<const LearnedCosts> parse_learned_costs(std::string_view text) {
    return parse_costs<LearnedCosts>(text, "conelane train rld", "learned costs");
}
std::shared_ptr<const StripCosts> parse_strip_costs(std::string_view text) {
    return parse_costs<StripCosts>(text, "conelane train strip", "strip costs");
}

std::shared_ptr<const LearnedCosts> read_learned_costs(const std::filesystem::path& file) {
    return read_costs(file, parse_learned_costs);
}
std::shared_ptr<const StripCosts> read_strip_costs(const std::filesystem::path& file) {
    return read_costs(file, parse_strip_costs);
}

std::vector<std::string_view> rld_parameter_set_names() {
    std::vector<std::string_view> names;
    for (const ParameterSet& set : parameter_sets()) names.push_back(set.name);
    return names;
}

std::optional<RldParameters> rld_parameter_set(std::string_view name) {
    const auto set = std::ranges::find(parameter_sets(), name, &ParameterSet::name);
    if (set == parameter_sets().end()) return std::nullopt;
    return set->parameters;
}

}  // namespace conelane
