#include "detectors/parameters/learned_costs_reader.hpp"

#include "graph_search/shared/weights_reader.hpp"

#include <string>
#include <utility>

namespace conelane {

namespace {

template <typename Costs>
std::shared_ptr<const Costs> parse(std::string_view text, std::string_view command, std::string_view of) {
    WeightsReader file(text, "weights", command);
    (void)file.version({1});
    Costs costs;
    for (const auto part : costs.kParts)
        file.require_features("features." + std::string(to_string(part)), learned_features(part));
    for_each_costs_list(
        costs, [&](const std::string& key, std::vector<double>& numbers) { numbers = file.numbers(key); });
    file.require_no_other(of);
    validate(costs);
    return std::make_shared<const Costs>(std::move(costs));
}

}  // namespace

std::shared_ptr<const LearnedCosts> parse_learned_costs(std::string_view text) {
    return parse<LearnedCosts>(text, "conelane train rld", "learned costs");
}

std::shared_ptr<const StripCosts> parse_strip_costs(std::string_view text) {
    return parse<StripCosts>(text, "conelane train strip", "costs of strips");
}

std::shared_ptr<const LearnedCosts> read_learned_costs(const std::filesystem::path& file) {
    std::shared_ptr<const LearnedCosts> costs;
    with_weights_file(file, [&](std::string_view text) { costs = parse_learned_costs(text); });
    return costs;
}

}  // namespace conelane
