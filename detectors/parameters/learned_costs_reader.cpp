#include "detectors/parameters/learned_costs_reader.hpp"

#include "conelane/invalid_input.hpp"
#include "graph_search/shared/json_reader.hpp"
#include "graph_search/shared/weights_bytes.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace conelane {
namespace {

constexpr int kVersion = 1;

using NamesByPart = std::map<std::string, std::vector<std::string>, std::less<>>;

NamesByPart read_features(JsonReader& json) {
    if (json.next() != '{') throw InvalidInput("features", "must be an object of lists of names");
    NamesByPart names;
    json.object([&](const std::string& part) {
        const auto is_part = [&](LearnedPart known) { return to_string(known) == part; };
        if (std::ranges::none_of(kLearnedParts, is_part))
            throw InvalidInput("features", "'" + part + "' is not a list of the library");
        if (names.contains(part)) throw InvalidInput("features", "'" + part + "' is there twice");
        if (json.next() != '[') throw InvalidInput("features", "'" + part + "' must be a list of names");
        std::vector<std::string>& list = names[part];
        json.array([&] {
            if (json.next() != '"') throw InvalidInput("features", "'" + part + "' must hold names");
            list.push_back(json.string());
        });
    });
    return names;
}

/// The file's features have to be those of the library, in the same order.
void require_features(const NamesByPart& names) {
    for (const LearnedPart part : kLearnedParts) {
        const std::string quoted = "'" + std::string(to_string(part)) + "'";
        const auto given = names.find(to_string(part));
        if (given == names.end()) throw InvalidInput("features", quoted + " is missing");
        const auto known = learned_features(part);
        for (std::size_t i = 0; i < given->second.size(); ++i) {
            if (i < known.size() && known[i].name == given->second[i]) continue;
            throw InvalidInput("features", quoted + " has '" + given->second[i] + "' at place " +
                                               std::to_string(i) +
                                               ", unlike the library: the weights are of another version");
        }
        if (given->second.size() != known.size())
            throw InvalidInput("features", quoted + " has " + std::to_string(given->second.size()) +
                                               " names, not " + std::to_string(known.size()) +
                                               " as the library: the weights are of another version");
    }
}

std::vector<double> read_numbers(JsonReader& json, const std::string& key) {
    std::vector<double> numbers;
    if (json.next() != '[') throw InvalidInput(key, "must be a list of numbers");
    json.array([&] {
        if (!json.is_number())
            throw InvalidInput(key, "number " + std::to_string(numbers.size()) + " (from 0) is not a number");
        numbers.push_back(json.number());
    });
    return numbers;
}

}  // namespace

std::shared_ptr<const LearnedCosts> parse_learned_costs(std::string_view text) {
    JsonReader json(text, "weights");
    if (json.next() != '{') json.fail("must be a JSON object, as `conelane train rld` writes it");
    LearnedCosts costs;
    std::map<std::string, std::vector<double>*, std::less<>> lists;
    for (const LearnedPart part : kLearnedParts) {
        const std::string name(to_string(part));
        LearnedNetwork& network = costs.of(part);
        lists[name + "_linear"] = &network.linear;
        lists[name + "_hidden"] = &network.hidden;
        lists[name + "_output"] = &network.output;
    }
    NamesByPart names;
    std::set<std::string, std::less<>> seen;
    json.object([&](const std::string& key) {
        if (!seen.insert(key).second) throw InvalidInput(key, "is there twice");
        if (const auto list = lists.find(key); list != lists.end()) {
            *list->second = read_numbers(json, key);
        } else if (key == "version") {
            if (!json.is_number() || json.number() != kVersion)
                throw InvalidInput(key, "must be " + std::to_string(kVersion));
        } else if (key == "features") {
            names = read_features(json);
        } else if (key == "training") {
            json.skip();
        } else {
            throw InvalidInput(key, "is not a key of learned costs");
        }
    });
    json.require_end();
    const auto require = [&](std::string_view key) {
        if (!seen.contains(key)) throw InvalidInput(std::string(key), "is missing");
    };
    require("version");
    require("features");
    require_features(names);
    for (const auto& [key, list] : lists) require(key);
    validate(costs);
    return std::make_shared<const LearnedCosts>(std::move(costs));
}

std::shared_ptr<const LearnedCosts> read_learned_costs(const std::filesystem::path& file) {
    std::shared_ptr<const LearnedCosts> costs;
    with_weights_file(file, [&](std::string_view text) { costs = parse_learned_costs(text); });
    return costs;
}

}  // namespace conelane
