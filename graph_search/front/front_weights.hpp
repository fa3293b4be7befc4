#pragma once

#include "graph_search/front/front_network.hpp"

#include <array>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

namespace conelane {

/// What `front` has learned for one kind of scenes.
struct FrontWeightSet {
    // The score of a lane is the sum over its start and its moves, see FrontCost.
    FrontNetworkWeights extend;
    FrontNetworkWeights stop;
    FrontNetworkWeights start;  ///< of a pair, once as each boundary sees it
    // What is said of the best lanes as a whole, see FrontJudge.
    FrontNetworkWeights rank;    ///< added to the score of a lane
    FrontNetworkWeights usable;  ///< log odds that the best lane is usable
    FrontNetworkWeights right;   ///< log odds that a cone of it is right where all before it are
    /// A lane is trusted as far as it is right by `right`, times `usable`, with this probability. Of lanes
    /// that are not usable, most look right cone by cone.
    double least_trust = 1.0;

    bool operator==(const FrontWeightSet&) const = default;
};

/// A network of a set: its key in files, and the feature lists that are its inputs (see
/// front_feature_lists).
struct FrontNetworkPlace {
    std::string_view key;
    FrontNetworkWeights FrontWeightSet::*network;
    std::array<std::string_view, 3> inputs;  ///< empty behind the last one
};
/// In the order of files.
inline constexpr std::array<FrontNetworkPlace, 6> kFrontNetworks{{
    {"extend", &FrontWeightSet::extend, {"state", "extend"}},
    {"stop", &FrontWeightSet::stop, {"state", "stop"}},
    {"start", &FrontWeightSet::start, {"start"}},
    {"rank", &FrontWeightSet::rank, {"lane"}},
    {"usable", &FrontWeightSet::usable, {"lane"}},
    {"right", &FrontWeightSet::right, {"cone", "state", "extend"}},
}};

struct FrontFeatureList;
[[nodiscard]] std::vector<FrontFeatureList> input_lists(const FrontNetworkPlace& place);

/// Calls use(place, key, numbers, each) for each list of numbers of a set, in the order of files. `each`: how
/// many of them belong to one input; 0 if they belong to none.
template <typename Set, typename Use>
void for_each_weights_list(Set& set, const Use& use) {
    for (const FrontNetworkPlace& place : kFrontNetworks) {
        auto& network = set.*place.network;
        use(place, "hidden", std::span(network.hidden), kFrontUnits);
        use(place, "hidden_bias", std::span(network.hidden_bias), std::size_t{0});
        use(place, "output", std::span(network.output), std::size_t{0});
        use(place, "linear", std::span(network.linear), std::size_t{1});
        use(place, "output_bias", std::span(&network.output_bias, 1), std::size_t{0});
    }
}

/// All that `front` has learned: a set for scenes without colors, and one for the others.
struct FrontWeights : FrontWeightSet {
    /// Of scenes where a cone has a color. Without it the first set serves all scenes.
    std::optional<FrontWeightSet> colored = {};

    /// All 0, of the right sizes, without a set for colors.
    [[nodiscard]] static FrontWeights zero();
    bool operator==(const FrontWeights&) const = default;
};

/// Throws InvalidInput naming the key; those of the set for colors begin with `colored_`.
void validate(const FrontWeights& weights);

/// The weights of `front` from the bytes of a file that `conelane train front --out FILE` wrote: a JSON
/// object with `version` 1 to 3, `features`, the names of the inputs as the library has them, and the numbers
/// of the networks, such as `extend_hidden`. In files of version 1 the features of colors are absent: they
/// get weights of 0, so that colors make no difference. Throws InvalidInput naming the key, or the line that
/// is not JSON.
[[nodiscard]] FrontWeights parse_front_weights(std::string_view json);

/// The same from a file. Throws InvalidInput naming the file too, also if it cannot be read.
[[nodiscard]] FrontWeights read_front_weights(const std::filesystem::path& file);

}  // namespace conelane
