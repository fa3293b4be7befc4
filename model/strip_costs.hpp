#pragma once

#include "conelane/learned_costs.hpp"

namespace conelane {

/// What a learned cost of the strip program is of. All are the same for a mirrored scene.
enum class StripPart { edge, triangle, start, turn, end };
inline constexpr std::array kStripParts{StripPart::edge, StripPart::triangle, StripPart::start,
                                        StripPart::turn, StripPart::end};
[[nodiscard]] constexpr auto parts_of(StripPart /*any*/) {
    return kStripParts;
}
/// As files spell it: `edge`, `triangle`, `start`, `turn`, `end`.
[[nodiscard]] std::string_view to_string(StripPart part);
/// All features of a part, in the order of their weights; strip_features.cpp defines each.
[[nodiscard]] std::span<const LearnedFeature> learned_features(StripPart part);

/// Learned costs of the strip program: each column costs what its network says, without a limit.
using StripCosts = PartNetworks<StripPart>;
/// Linear costs that were set by hand: they find the lanes of easy scenes. A training begins with them.
[[nodiscard]] StripCosts hand_set_strip_costs();

inline constexpr std::size_t kStripEdgeFeatures = 12;
inline constexpr std::size_t kStripTriangleFeatures = 16;
inline constexpr std::size_t kStripStartFeatures = 13;
inline constexpr std::size_t kStripTurnFeatures = 11;
inline constexpr std::size_t kStripInnerFeature = 8;  ///< of a turn: 0 unless the lane is inside
inline constexpr std::size_t kStripEndFeatures = 8;

}  // namespace conelane
