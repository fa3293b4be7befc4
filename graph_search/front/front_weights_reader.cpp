#include "graph_search/front/front_weights_reader.hpp"

#include "conelane/invalid_input.hpp"
#include "graph_search/front/front_features.hpp"
#include "graph_search/front/front_judge_features.hpp"
#include "graph_search/shared/json_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <limits>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace conelane {
namespace {

constexpr double kVersion = 1.0;

/// The inputs have to be those that the library computes, in their order.
void read_features(JsonReader& json) {
    if (json.next() != '{') throw InvalidInput("features", "must be an object of lists of names");
    std::set<std::string> seen;
    json.object([&](const std::string& key) {
        const auto lists = front_feature_lists();
        const auto known = std::ranges::find(lists, key, &FrontFeatureList::key);
        if (known == lists.end())
            throw InvalidInput("features", "'" + key + "' is not a list of the library");
        if (!seen.insert(key).second) throw InvalidInput("features", "'" + key + "' is there twice");
        if (json.next() != '[') throw InvalidInput("features", "'" + key + "' must be a list of names");
        std::size_t count = 0;
        json.array([&] {
            if (json.next() != '"') throw InvalidInput("features", "'" + key + "' must hold names");
            const std::string name = json.string();
            if (count >= known->features.size() || known->features[count].name != name) {
                throw InvalidInput("features",
                                   "'" + key + "' has '" + name + "' at place " + std::to_string(count) +
                                       ", unlike the library: the weights are of another version");
            }
            ++count;
        });
        if (count != known->features.size())
            throw InvalidInput("features", "'" + key + "' has " + std::to_string(count) + " names, not " +
                                               std::to_string(known->features.size()) +
                                               " as the library: the weights are of another version");
    });
    for (const FrontFeatureList& list : front_feature_lists()) {
        if (!seen.contains(std::string(list.key)))
            throw InvalidInput("features", "'" + std::string(list.key) + "' is missing");
    }
}

void read_numbers(JsonReader& json, const std::string& key, std::span<float> numbers) {
    const auto fail = [&](const std::string& reason) { throw InvalidInput(key, reason); };
    const std::string size = std::to_string(numbers.size());
    if (json.next() != '[') fail("must be a list of " + size + " numbers");
    std::size_t count = 0;
    json.array([&] {
        const std::string place = "number " + std::to_string(count);
        if (!json.is_number()) fail(place + " (from 0) is not a number");
        const double number = json.number();
        if (std::abs(number) > static_cast<double>(std::numeric_limits<float>::max()))
            fail(place + " (from 0) is out of range");
        if (count < numbers.size()) numbers[count] = static_cast<float>(number);
        ++count;
    });
    if (count != numbers.size()) fail("has " + std::to_string(count) + " numbers, not " + size);
}

struct NumberList {
    std::string key;
    std::span<float> numbers;
};

/// All lists of numbers of a file.
std::vector<NumberList> number_lists(FrontWeights& weights) {
    std::vector<NumberList> lists;
    const auto add = [&lists](const std::string& name, FrontNetworkWeights& network) {
        lists.push_back({name + "_hidden", network.hidden});
        lists.push_back({name + "_hidden_bias", network.hidden_bias});
        lists.push_back({name + "_output", network.output});
        lists.push_back({name + "_linear", network.linear});
        lists.push_back({name + "_output_bias", std::span(&network.output_bias, 1)});
    };
    add("extend", weights.extend);
    add("stop", weights.stop);
    add("start", weights.start);
    add("rank", weights.rank);
    add("usable", weights.usable);
    add("right", weights.right);
    return lists;
}

double read_number(JsonReader& json, const std::string& key) {
    if (!json.is_number()) throw InvalidInput(key, "must be a number");
    return json.number();
}

#ifdef __wasi__  // a WebAssembly module has no files: weights come as bytes
std::string bytes_of(const std::filesystem::path& /*file*/) {
    throw InvalidInput("weights", "cannot be read");
}
#else
std::string bytes_of(const std::filesystem::path& file) {
    constexpr std::size_t kMaxBytes = std::size_t{64} << 20U;  // the shipped file has 0.13 MB
    std::ifstream stream(file, std::ios::binary);
    std::string bytes(1U << 16U, '\0');
    std::size_t size = 0;
    while (stream && size <= kMaxBytes) {
        if (size == bytes.size()) bytes.resize(2 * bytes.size());
        stream.read(bytes.data() + size, static_cast<std::streamsize>(bytes.size() - size));
        size += static_cast<std::size_t>(stream.gcount());
    }
    if (!stream.eof()) throw InvalidInput("weights", size > kMaxBytes ? "is too large" : "cannot be read");
    bytes.resize(size);
    return bytes;
}
#endif

}  // namespace

FrontWeights parse_front_weights(std::string_view text) {
    JsonReader json(text, "weights");
    if (json.next() != '{') json.fail("must be a JSON object, as `conelane train front` writes it");
    FrontWeights weights = FrontWeights::zero();
    const std::vector<NumberList> lists = number_lists(weights);
    std::set<std::string> seen;
    std::string unknown;
    json.object([&](const std::string& key) {
        if (!seen.insert(key).second) throw InvalidInput(key, "is there twice");
        const auto list = std::ranges::find(lists, key, &NumberList::key);
        if (list != lists.end()) {
            read_numbers(json, key, list->numbers);
        } else if (key == "version") {
            if (read_number(json, key) != kVersion) throw InvalidInput(key, "must be 1");
        } else if (key == "features") {
            read_features(json);
        } else if (key == "least_trust") {
            weights.least_trust = read_number(json, key);
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
    for (const NumberList& list : lists) require(list.key);
    require("least_trust");
    if (!unknown.empty()) throw InvalidInput(unknown, "is not a key of weights of front");
    validate(weights);
    return weights;
}

FrontWeights read_front_weights(const std::filesystem::path& file) {
    try {
        return parse_front_weights(bytes_of(file));
    } catch (const InvalidInput& error) {
        const std::string what = error.what();
        const std::string prefix = "weights: ";
        throw InvalidInput(
            "weights", file.string() + ": " + (what.starts_with(prefix) ? what.substr(prefix.size()) : what));
    }
}

}  // namespace conelane
