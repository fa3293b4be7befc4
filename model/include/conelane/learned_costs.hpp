#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace conelane {

/// What a learned cost is of.
enum class LearnedPart { edge, turn, near_end, far_end };
inline constexpr std::array kLearnedParts{LearnedPart::edge, LearnedPart::turn, LearnedPart::near_end,
                                          LearnedPart::far_end};
[[nodiscard]] constexpr auto parts_of(LearnedPart /*any*/) {
    return kLearnedParts;
}
/// As files spell it: `edge`, `turn`, `near_end`, `far_end`.
[[nodiscard]] std::string_view to_string(LearnedPart part);

/// A measured number that a learned cost depends on.
struct LearnedFeature {
    std::string_view name;
    std::string_view unit;    ///< what the value 1 stands for, such as "3 m"; "1": a plain number
    std::string_view reason;  ///< what a high value means
};
/// All features of a part, in the order of their weights. The first one is 1 everywhere.
[[nodiscard]] std::span<const LearnedFeature> learned_features(LearnedPart part);

/// linear * x + sum over units u of output_u max(0, hidden_u * x). Without units it is linear. Sums run in
/// the order of the numbers, in double, without fused operations: the result is the same on every machine.
struct LearnedNetwork {
    std::vector<double> linear;  ///< one a feature
    std::vector<double> hidden;  ///< hidden_u of feature i is number i * units() + u
    std::vector<double> output;  ///< one a unit

    [[nodiscard]] static LearnedNetwork zero(std::size_t features, std::size_t units);
    [[nodiscard]] std::size_t units() const { return output.size(); }
    /// Precondition: the network is valid for this number of features.
    [[nodiscard]] double operator()(std::span<const double> features) const;
    bool operator==(const LearnedNetwork&) const = default;
};

/// Throws InvalidInput naming network and list, such as `edge.hidden`, if a size is wrong, a number is not in
/// [-1e6, 1e6], or there are more than 256 units.
void validate(const LearnedNetwork& network, std::string_view name, std::size_t features);

/// A network for each part of a program. Part: an enumeration with parts_of, to_string and learned_features.
template <typename Part>
struct PartNetworks {
    static constexpr auto kParts = parts_of(Part{});
    std::array<LearnedNetwork, kParts.size()> networks;

    [[nodiscard]] const LearnedNetwork& of(Part part) const {
        return networks[static_cast<std::size_t>(part)];
    }
    [[nodiscard]] LearnedNetwork& of(Part part) { return networks[static_cast<std::size_t>(part)]; }
    /// All 0, with `units` hidden units in each network.
    [[nodiscard]] static PartNetworks zero(std::size_t units = 0) {
        PartNetworks costs;
        for (const Part part : kParts)
            costs.of(part) = LearnedNetwork::zero(learned_features(part).size(), units);
        return costs;
    }
    bool operator==(const PartNetworks&) const = default;
};
template <typename Part>
void validate(const PartNetworks<Part>& costs) {
    for (const Part part : costs.kParts)
        validate(costs.of(part), to_string(part), learned_features(part).size());
}

/// Learned costs of the lane graph problem, by part. They are added to the costs of (29):
/// - of an edge, the network itself,
/// - of a turn, the network where it is positive, else 0, so that no turn gains,
/// - of a near or far end, the network where it is negative, else 0, so that no end costs.
/// The signs restrict nothing: every lane graph has two near and two far ends, and two turns fewer than
/// edges. So a constant that moves from turns to edges, or is added to all ends, changes no optimum.
struct LearnedCosts : PartNetworks<LearnedPart> {
    [[nodiscard]] static LearnedCosts zero(std::size_t units = 0) { return {PartNetworks::zero(units)}; }
    bool operator==(const LearnedCosts&) const = default;
};

}  // namespace conelane
