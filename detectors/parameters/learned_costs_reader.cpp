#include "detectors/parameters/learned_costs_reader.hpp"

#include "graph_search/shared/weights_reader.hpp"

#include <utility>

namespace conelane {

std::shared_ptr<const LearnedCosts> parse_learned_costs(std::string_view text) {
    WeightsReader file(text, "weights", "conelane train rld");
    (void)file.version({1});
    for (const LearnedPart part : kLearnedParts)
        file.require_features("features." + std::string(to_string(part)), learned_features(part));
    LearnedCosts costs;
    for_each_costs_list(
        costs, [&](const std::string& key, std::vector<double>& numbers) { numbers = file.numbers(key); });
    file.require_no_other("learned costs");
    validate(costs);
    return std::make_shared<const LearnedCosts>(std::move(costs));
}

std::shared_ptr<const LearnedCosts> read_learned_costs(const std::filesystem::path& file) {
    std::shared_ptr<const LearnedCosts> costs;
    with_weights_file(file, [&](std::string_view text) { costs = parse_learned_costs(text); });
    return costs;
}

}  // namespace conelane
