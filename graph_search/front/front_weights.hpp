#pragma once

#include "graph_search/shared/simd_batch.hpp"

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace conelane {

/// Units of the hidden layer of each network.
inline constexpr std::size_t kFrontUnits = 48;

/// A network of one hidden layer beside a linear part:
/// score = output_bias + linear * x + output * max(0, hidden_bias + hidden * x).
struct FrontNetworkWeights {
    std::size_t inputs = 0;
    std::vector<float> hidden;  ///< kFrontUnits for each input, one input after the other
    std::vector<float> hidden_bias;
    std::vector<float> output;
    std::vector<float> linear;
    float output_bias = 0.0F;

    /// All 0.
    [[nodiscard]] static FrontNetworkWeights zero(std::size_t inputs);
    /// The number of all weights.
    [[nodiscard]] std::size_t size() const { return inputs * (kFrontUnits + 1) + 2 * kFrontUnits + 1; }
    bool operator==(const FrontNetworkWeights&) const = default;
};

/// Throws InvalidInput naming the key, after `prefix`, where a size is wrong or a number not finite.
void validate(const FrontNetworkWeights& weights, std::string_view prefix);

/// The sums of the hidden units and of the linear part over the first inputs, which several moves of one
/// state have in common: they are computed once.
struct FrontSums {
    alignas(32) std::array<float, kFrontUnits> hidden;
    float linear;
};

/// Inference. Sums run in a fixed order, eight units at a time on every processor, so the results are
/// identical to the last bit.
class FrontNetwork {
  public:
    explicit FrontNetwork(FrontNetworkWeights weights) : weights_(std::move(weights)) {}

    [[nodiscard]] const FrontNetworkWeights& weights() const { return weights_; }
    /// The sums over the first inputs.
    void begin(std::span<const float> first_inputs, FrontSums& sums) const;
    /// Adds the inputs from `first` on to `sums` and returns the scores of two moves; `inputs` holds those of
    /// one move after those of the other. The last `unused` inputs of each are 0 and are skipped.
    void score(const FrontSums& sums, std::size_t first, std::span<const float> inputs,
               std::span<float> scores, std::size_t unused = 0) const;
    /// The score of all inputs.
    [[nodiscard]] float score(std::span<const float> inputs) const;

  private:
    FrontNetworkWeights weights_;
};

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
[[nodiscard]] FrontWeights parse_front_weights(std::string_view text);

/// The same from a file. Throws InvalidInput naming the file too, also if it cannot be read.
[[nodiscard]] FrontWeights read_front_weights(const std::filesystem::path& file);

}  // namespace conelane
