#include "graph_search/front/front_weights.hpp"

#include "conelane/invalid_input.hpp"
#include "graph_search/front/front_features.hpp"
#include "graph_search/shared/weights_reader.hpp"

namespace conelane {
namespace {

/// A batch of numbers in registers, for any register width; stored in an array of float.
using Floats [[gnu::vector_size(32)]] = float;
using UnalignedFloats [[gnu::vector_size(32), gnu::aligned(4), gnu::may_alias]] = float;
constexpr std::size_t kFloats = sizeof(Floats) / sizeof(float);
constexpr std::size_t kParts = kFrontUnits / kFloats;
static_assert(kFrontUnits % kFloats == 0);

/// The weights of an input. Not `auto`: GCC would then assume the alignment of Floats, which an array of
/// float does not have.
const UnalignedFloats* row_of(const float* weights, std::size_t input) {
    return reinterpret_cast<const UnalignedFloats*>(weights + input * kFrontUnits);
}

// NOLINTBEGIN(modernize-avoid-c-arrays): std::array drops the attribute of its vectors

CONELANE_SIMD void add_inputs(const float* weights, const float* inputs, std::size_t count, float* sums) {
    Floats part[kParts];
    for (std::size_t p = 0; p < kParts; ++p) part[p] = reinterpret_cast<const UnalignedFloats*>(sums)[p];
    for (std::size_t i = 0; i < count; ++i) {
        const UnalignedFloats* const row = row_of(weights, i);
        for (std::size_t p = 0; p < kParts; ++p) part[p] += inputs[i] * row[p];
    }
    for (std::size_t p = 0; p < kParts; ++p) reinterpret_cast<UnalignedFloats*>(sums)[p] = part[p];
}

/// Adds the hidden units' contribution to the scores of two moves, so that each weight is read once.
CONELANE_SIMD void add_hidden(const float* weights, const float* first, const float* second,
                              std::size_t count, const float* sums, const float* output, float* results) {
    Floats a[kParts];
    Floats b[kParts];
    for (std::size_t p = 0; p < kParts; ++p) a[p] = b[p] = reinterpret_cast<const UnalignedFloats*>(sums)[p];
    for (std::size_t i = 0; i < count; ++i) {
        const UnalignedFloats* const row = row_of(weights, i);
        for (std::size_t p = 0; p < kParts; ++p) {
            const Floats weight = row[p];
            a[p] += first[i] * weight;
            b[p] += second[i] * weight;
        }
    }
    Floats sum_a{};
    Floats sum_b{};
    for (std::size_t p = 0; p < kParts; ++p) {
        const Floats weight = reinterpret_cast<const UnalignedFloats*>(output)[p];
        sum_a += weight * (a[p] > 0.0F ? a[p] : Floats{});
        sum_b += weight * (b[p] > 0.0F ? b[p] : Floats{});
    }
    for (std::size_t j = 0; j < kFloats; ++j) {
        results[0] += sum_a[j];
        results[1] += sum_b[j];
    }
}

// NOLINTEND(modernize-avoid-c-arrays)

float dot(const float* a, const float* b, std::size_t count) {
    float sum = 0.0F;
    for (std::size_t i = 0; i < count; ++i) sum += a[i] * b[i];
    return sum;
}

std::size_t inputs_of(const FrontNetworkPlace& place) {
    std::size_t inputs = 0;
    for (const FrontFeatureList& list : input_lists(place)) inputs += list.features.size();
    return inputs;
}

void validate_set(const FrontWeightSet& weights, const std::string& prefix) {
    for (const FrontNetworkPlace& place : kFrontNetworks) {
        const std::string name = prefix + std::string(place.key);
        if ((weights.*place.network).inputs != inputs_of(place))
            throw InvalidInput(name + ".inputs", "must be " + std::to_string(inputs_of(place)));
        validate(weights.*place.network, name);
    }
    if (!(weights.least_trust >= 0.0 && weights.least_trust <= 1.0))
        throw InvalidInput(prefix + "least_trust", "must be in [0, 1]");
}

/// Files of version 1 have no features of colors: their weights are 0. Those of version 2 have one set of
/// weights for all scenes, those of version 3 a second one for scenes with colors.
constexpr int kWithoutColors = 1;
constexpr int kOneSet = 2;
constexpr int kTwoSets = 3;

/// Features of a list that are in a file of that version.
std::span<const FrontFeature> features_in(const FrontFeatureList& list, int version) {
    return list.features.first(list.features.size() - (version == kWithoutColors ? list.colors : 0));
}

/// Reads the keys that begin with `prefix`. The weights of inputs that the version does not have stay
/// unchanged.
void read_set(WeightsReader& file, const std::string& prefix, int version, FrontWeightSet& weights) {
    for_each_weights_list(weights, [&](const FrontNetworkPlace& place, const char* list,
                                       std::span<float> numbers, std::size_t each) {
        const std::vector<FrontFeatureList> inputs =
            each > 0 ? input_lists(place) : std::vector<FrontFeatureList>{};
        std::size_t count = each > 0 ? 0 : numbers.size();
        for (const FrontFeatureList& input : inputs) count += each * features_in(input, version).size();
        const std::vector<float> given = file.floats(prefix + std::string(place.key) + "_" + list, count);
        if (each == 0) std::ranges::copy(given, numbers.begin());
        auto from = given.begin();
        auto to = numbers.begin();
        for (const FrontFeatureList& input : inputs) {
            const std::size_t size = each * features_in(input, version).size();
            std::copy_n(from, size, to);
            from += static_cast<std::ptrdiff_t>(size);
            to += static_cast<std::ptrdiff_t>(each * input.features.size());
        }
    });
    weights.least_trust = file.number(prefix + "least_trust");
}

}  // namespace

FrontNetworkWeights FrontNetworkWeights::zero(std::size_t inputs) {
    FrontNetworkWeights weights;
    weights.inputs = inputs;
    weights.hidden.assign(inputs * kFrontUnits, 0.0F);
    weights.hidden_bias.assign(kFrontUnits, 0.0F);
    weights.output.assign(kFrontUnits, 0.0F);
    weights.linear.assign(inputs, 0.0F);
    return weights;
}

void validate(const FrontNetworkWeights& weights, std::string_view prefix) {
    const auto require = [&](const std::vector<float>& numbers, std::size_t size, const char* key) {
        const std::string path = std::string(prefix) + "." + key;
        if (numbers.size() != size)
            throw InvalidInput(path, "must have " + std::to_string(size) + " numbers");
        if (!std::ranges::all_of(numbers, [](float number) { return std::isfinite(number); })) {
            throw InvalidInput(path, "must hold finite numbers");
        }
    };
    require(weights.hidden, weights.inputs * kFrontUnits, "hidden");
    require(weights.hidden_bias, kFrontUnits, "hidden_bias");
    require(weights.output, kFrontUnits, "output");
    require(weights.linear, weights.inputs, "linear");
    if (!std::isfinite(weights.output_bias))
        throw InvalidInput(std::string(prefix) + ".output_bias", "must be finite");
}

void FrontNetwork::begin(std::span<const float> first_inputs, FrontSums& sums) const {
    std::ranges::copy(weights_.hidden_bias, sums.hidden.begin());
    add_inputs(weights_.hidden.data(), first_inputs.data(), first_inputs.size(), sums.hidden.data());
    sums.linear =
        weights_.output_bias + dot(weights_.linear.data(), first_inputs.data(), first_inputs.size());
}

void FrontNetwork::score(const FrontSums& sums, std::size_t first, std::span<const float> inputs,
                         std::span<float> scores, std::size_t unused) const {
    const std::size_t stride = weights_.inputs - first;
    const std::size_t count = stride - unused;
    const float* const hidden = weights_.hidden.data() + first * kFrontUnits;
    const float* const linear = weights_.linear.data() + first;
    for (std::size_t i = 0; i < scores.size(); i += 2) {
        const float* const a = inputs.data() + i * stride;
        const bool is_pair = i + 1 < scores.size();
        const float* const b = is_pair ? a + stride : a;
        std::array<float, 2> results{sums.linear + dot(linear, a, count),
                                     sums.linear + dot(linear, b, count)};
        add_hidden(hidden, a, b, count, sums.hidden.data(), weights_.output.data(), results.data());
        scores[i] = results[0];
        if (is_pair) scores[i + 1] = results[1];
    }
}

float FrontNetwork::score(std::span<const float> inputs) const {
    FrontSums sums{};
    begin({}, sums);
    float result = 0.0F;
    score(sums, 0, inputs, {&result, 1});
    return result;
}

std::vector<FrontFeatureList> input_lists(const FrontNetworkPlace& place) {
    const auto all = front_feature_lists();
    std::vector<FrontFeatureList> lists;
    for (const std::string_view key : place.inputs) {
        if (!key.empty()) lists.push_back(*std::ranges::find(all, key, &FrontFeatureList::key));
    }
    return lists;
}

FrontWeights FrontWeights::zero() {
    FrontWeights weights;
    for (const FrontNetworkPlace& place : kFrontNetworks)
        weights.*place.network = FrontNetworkWeights::zero(inputs_of(place));
    return weights;
}

void validate(const FrontWeights& weights) {
    validate_set(weights, "");
    if (weights.colored) validate_set(*weights.colored, "colored_");
}

FrontWeights parse_front_weights(std::string_view text) {
    WeightsReader file(text, "weights", "conelane train front");
    const int version = file.version({kWithoutColors, kOneSet, kTwoSets});
    for (const FrontFeatureList& list : front_feature_lists())
        file.require_features("features." + std::string(list.key), features_in(list, version));
    FrontWeights weights = FrontWeights::zero();
    const FrontWeightSet zero = weights;
    read_set(file, "", version, weights);
    if (version == kTwoSets) read_set(file, "colored_", version, weights.colored.emplace(zero));
    file.require_no_other("weights of front");
    validate(weights);
    return weights;
}

FrontWeights read_front_weights(const std::filesystem::path& file) {
    FrontWeights weights;
    with_weights_file(file, [&](std::string_view text) { weights = parse_front_weights(text); });
    return weights;
}

}  // namespace conelane
