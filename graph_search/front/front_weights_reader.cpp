#include "graph_search/front/front_weights_reader.hpp"

#include "conelane/invalid_input.hpp"
#include "graph_search/front/front_features.hpp"
#include "graph_search/front/front_judge_features.hpp"
#include "graph_search/shared/json_reader.hpp"
#include "graph_search/shared/weights_bytes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace conelane {
namespace {

/// Files of version 1 have no features of colors: their weights are 0. Those of version 2 have one set of
/// weights for all scenes, those of version 3 a second one for scenes with colors.
constexpr int kWithoutColors = 1;
constexpr int kOneSet = 2;
constexpr int kTwoSets = 3;

/// Prefix of the keys of the second set.
constexpr std::string_view kOfColors = "colored_";
constexpr std::string_view kLeastTrust = "least_trust";

/// Number of a list's features in a file of that version.
std::size_t names_in(const FrontFeatureList& list, int version) {
    return list.features.size() - (version == kWithoutColors ? list.colors : 0);
}

/// The names of a file, by list.
using NamesByList = std::map<std::string, std::vector<std::string>, std::less<>>;

NamesByList read_features(JsonReader& json) {
    if (json.next() != '{') throw InvalidInput("features", "must be an object of lists of names");
    NamesByList names;
    json.object([&](const std::string& key) {
        const auto lists = front_feature_lists();
        if (std::ranges::find(lists, key, &FrontFeatureList::key) == lists.end())
            throw InvalidInput("features", "'" + key + "' is not a list of the library");
        if (names.contains(key)) throw InvalidInput("features", "'" + key + "' is there twice");
        if (json.next() != '[') throw InvalidInput("features", "'" + key + "' must be a list of names");
        std::vector<std::string>& list = names[key];
        json.array([&] {
            if (json.next() != '"') throw InvalidInput("features", "'" + key + "' must hold names");
            list.push_back(json.string());
        });
    });
    return names;
}

/// The inputs have to be those that the library computes, in their order.
void require_features(const NamesByList& names, int version) {
    for (const FrontFeatureList& list : front_feature_lists()) {
        const std::string quoted = "'" + std::string(list.key) + "'";
        const auto given = names.find(list.key);
        if (given == names.end()) throw InvalidInput("features", quoted + " is missing");
        const std::size_t count = names_in(list, version);
        for (std::size_t i = 0; i < given->second.size(); ++i) {
            if (i < count && list.features[i].name == given->second[i]) continue;
            throw InvalidInput("features", quoted + " has '" + given->second[i] + "' at place " +
                                               std::to_string(i) +
                                               ", unlike the library: the weights are of another version");
        }
        if (given->second.size() != count)
            throw InvalidInput("features", quoted + " has " + std::to_string(given->second.size()) +
                                               " names, not " + std::to_string(count) +
                                               " as the library: the weights are of another version");
    }
}

std::vector<float> read_numbers(JsonReader& json, const std::string& key) {
    std::vector<float> numbers;
    if (json.next() != '[') throw InvalidInput(key, "must be a list of numbers");
    json.array([&] {
        const std::string place = "number " + std::to_string(numbers.size());
        if (!json.is_number()) throw InvalidInput(key, place + " (from 0) is not a number");
        const double number = json.number();
        if (std::abs(number) > static_cast<double>(std::numeric_limits<float>::max()))
            throw InvalidInput(key, place + " (from 0) is out of range");
        numbers.push_back(static_cast<float>(number));
    });
    return numbers;
}

/// A list of numbers in a file. With `inputs`, keys of lists of features: `each` numbers for each feature.
/// Without: as many numbers as `numbers` has.
struct NumberList {
    std::string key;
    std::span<float> numbers;
    std::vector<std::string_view> inputs;
    std::size_t each = 1;
};

/// Adds all lists of numbers of a set.
void add_lists(const std::string& prefix, FrontWeightSet& weights, std::vector<NumberList>& lists) {
    const auto add = [&](const char* of, FrontNetworkWeights& network,
                         const std::vector<std::string_view>& inputs) {
        const std::string name = prefix + of;
        lists.push_back({name + "_hidden", network.hidden, inputs, kFrontUnits});
        lists.push_back({name + "_hidden_bias", network.hidden_bias, {}});
        lists.push_back({name + "_output", network.output, {}});
        lists.push_back({name + "_linear", network.linear, inputs});
        lists.push_back({name + "_output_bias", std::span(&network.output_bias, 1), {}});
    };
    add("extend", weights.extend, {"state", "extend"});
    add("stop", weights.stop, {"state", "stop"});
    add("start", weights.start, {"start"});
    add("rank", weights.rank, {"lane"});
    add("usable", weights.usable, {"lane"});
    add("right", weights.right, {"cone", "state", "extend"});
}

/// Stores the numbers of a file of that version. The weights of inputs that the version does not have stay
/// unchanged.
void place(const std::vector<float>& numbers, const NumberList& list, int version) {
    const auto features = front_feature_lists();
    const auto list_of = [&](std::string_view key) -> const FrontFeatureList& {
        return *std::ranges::find(features, key, &FrontFeatureList::key);
    };
    std::size_t count = list.inputs.empty() ? list.numbers.size() : 0;
    for (const std::string_view key : list.inputs) count += list.each * names_in(list_of(key), version);
    if (numbers.size() != count)
        throw InvalidInput(
            list.key, "has " + std::to_string(numbers.size()) + " numbers, not " + std::to_string(count));
    if (list.inputs.empty()) std::ranges::copy(numbers, list.numbers.begin());
    auto from = numbers.begin();
    auto to = list.numbers.begin();
    for (const std::string_view key : list.inputs) {
        const auto size = static_cast<std::ptrdiff_t>(list.each * names_in(list_of(key), version));
        std::copy(from, from + size, to);
        from += size;
        to += static_cast<std::ptrdiff_t>(list.each * list_of(key).features.size());
    }
}

double read_number(JsonReader& json, const std::string& key) {
    if (!json.is_number()) throw InvalidInput(key, "must be a number");
    return json.number();
}

}  // namespace

FrontWeights parse_front_weights(std::string_view text) {
    JsonReader json(text, "weights");
    if (json.next() != '{') json.fail("must be a JSON object, as `conelane train front` writes it");
    FrontWeights weights = FrontWeights::zero();
    FrontWeightSet& colored = weights.colored.emplace(weights);
    std::vector<NumberList> lists;
    add_lists("", weights, lists);
    const std::size_t of_one_set = lists.size();
    add_lists(std::string(kOfColors), colored, lists);
    std::vector<std::vector<float>> numbers(lists.size());
    const std::string colored_least_trust = std::string(kOfColors) + std::string(kLeastTrust);
    NamesByList names;
    int version = 0;
    std::set<std::string> seen;
    std::string unknown;
    json.object([&](const std::string& key) {
        if (!seen.insert(key).second) throw InvalidInput(key, "is there twice");
        const auto list = std::ranges::find(lists, key, &NumberList::key);
        if (list != lists.end()) {
            numbers[static_cast<std::size_t>(list - lists.begin())] = read_numbers(json, key);
        } else if (key == "version") {
            const double given = read_number(json, key);
            for (const int known : {kWithoutColors, kOneSet, kTwoSets}) {
                if (given == known) version = known;
            }
            if (version == 0) throw InvalidInput(key, "must be 1, 2 or 3");
        } else if (key == "features") {
            names = read_features(json);
        } else if (key == kLeastTrust) {
            weights.least_trust = read_number(json, key);
        } else if (key == colored_least_trust) {
            colored.least_trust = read_number(json, key);
        } else {
            if (key != "training" && unknown.empty()) unknown = key;
            json.skip();
        }
    });
    json.require_end();
    const auto require = [&seen](const std::string& key) {
        if (!seen.contains(key)) throw InvalidInput(key, "is missing");
    };
    require("version");
    require("features");
    require_features(names, version);
    for (std::size_t i = 0; i < (version == kTwoSets ? lists.size() : of_one_set); ++i) {
        require(lists[i].key);
        place(numbers[i], lists[i], version);
    }
    require(std::string(kLeastTrust));
    if (version == kTwoSets) {
        require(colored_least_trust);
    } else {
        const auto of_colors =
            std::ranges::find_if(seen, [](const std::string& key) { return key.starts_with(kOfColors); });
        if (of_colors != seen.end()) throw InvalidInput(*of_colors, "is a key of version 3");
        weights.colored.reset();
    }
    if (!unknown.empty()) throw InvalidInput(unknown, "is not a key of weights of front");
    validate(weights);
    return weights;
}

FrontWeights read_front_weights(const std::filesystem::path& file) {
    FrontWeights weights;
    with_weights_file(file, [&](std::string_view text) { weights = parse_front_weights(text); });
    return weights;
}

}  // namespace conelane
