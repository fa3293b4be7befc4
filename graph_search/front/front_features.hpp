#pragma once

#include "graph_search/front/front_state.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>

namespace conelane {

/// An input of a network. Turns and sides are seen from the boundary that moves, with inward, towards the
/// other boundary, as positive: so a scene and its mirror image are judged alike.
struct FrontFeature {
    std::string_view name;
    std::string_view unit;    ///< of what is measured, before it is scaled to about 1
    std::string_view reason;  ///< what it tells, with what a high value means
};

/// A feature with the function that finds it. A schema is an array of these, and the only place that says in
/// which order the features of a network stand: tables, places and values all come from it.
template <typename Seen>
struct FrontFeatureOf {
    std::string_view name;
    std::string_view unit;
    std::string_view reason;
    float (*value)(const Seen&);  ///< of what was measured
};

template <typename Seen, std::size_t count>
constexpr std::array<FrontFeature, count> table_of(const std::array<FrontFeatureOf<Seen>, count>& schema) {
    std::array<FrontFeature, count> table{};
    for (std::size_t i = 0; i < count; ++i) table[i] = {schema[i].name, schema[i].unit, schema[i].reason};
    return table;
}

/// The place of a feature, found when this is compiled; an error there where none has the name.
template <typename Seen, std::size_t count>
consteval std::size_t place_of(const std::array<FrontFeatureOf<Seen>, count>& schema, std::string_view name) {
    for (std::size_t i = 0; i < count; ++i) {
        if (schema[i].name == name) return i;
    }
    throw "the schema has no feature of this name";
}

/// The values of all features of a schema.
template <const auto& schema, typename Seen>
std::array<float, schema.size()> values_of(const Seen& seen) {
    return [&seen]<std::size_t... place>(std::index_sequence<place...>) {
        return std::array<float, sizeof...(place)>{schema[place].value(seen)...};
    }
    (std::make_index_sequence<schema.size()>());
}

// The networks see: `extend` the state and the move, `stop` the state and the stop, `start` the pair.
// Features of colors stand last, and are all 0 if no cone of the scene has one.
inline constexpr std::size_t kStateColorFeatures = 5;
inline constexpr std::size_t kExtendColorFeatures = 6;
inline constexpr std::size_t kStopColorFeatures = 2;
inline constexpr std::size_t kStartColorFeatures = 5;
inline constexpr std::size_t kStateFeatures = 20 + kStateColorFeatures;
inline constexpr std::size_t kExtendFeatures = 28 + kExtendColorFeatures;
inline constexpr std::size_t kStopFeatures = 13 + kStopColorFeatures;
inline constexpr std::size_t kStartFeatures = 24 + kStartColorFeatures;
inline constexpr std::size_t kExtendInputs = kStateFeatures + kExtendFeatures;
inline constexpr std::size_t kStopInputs = kStateFeatures + kStopFeatures;

[[nodiscard]] std::span<const FrontFeature, kStateFeatures> state_feature_table();
[[nodiscard]] std::span<const FrontFeature, kExtendFeatures> extend_feature_table();
[[nodiscard]] std::span<const FrontFeature, kStopFeatures> stop_feature_table();
[[nodiscard]] std::span<const FrontFeature, kStartFeatures> start_feature_table();

using StateFeatures = std::array<float, kStateFeatures>;
using ExtendFeatures = std::array<float, kExtendFeatures>;
using StopFeatures = std::array<float, kStopFeatures>;
using StartFeatures = std::array<float, kStartFeatures>;

/// What all moves of one side have in common; computed once for them.
struct StateMeasures {
    double width_m;         ///< from the side's end to the other boundary
    double mean_width_m;    ///< of the lane so far
    double mean_segment_m;  ///< of both boundaries, some usual ones where there are few
    float log_mean_segment;
    /// The ways from the side's end to the left and to the right of the line to the other end; ways along the
    /// line are in both. Indices in FrontMap::edges, ascending.
    std::array<std::array<std::uint8_t, FrontMap::kMaxEdges>, 2> ways;
    std::array<std::size_t, 2> way_counts;
};
[[nodiscard]] StateMeasures measure(FrontMap& map, const FrontState& state, Side side);

[[nodiscard]] StateFeatures state_features(FrontMap& map, const FrontState& state, Side side,
                                           const StateMeasures& measures);
/// Precondition: the move extends.
[[nodiscard]] ExtendFeatures extend_features(FrontMap& map, const FrontState& state, Side side,
                                             const FrontMove& move, const StateMeasures& measures);
/// `extensions`: the features of all moves that extend, one move after the other.
[[nodiscard]] StopFeatures stop_features(FrontMap& map, const FrontState& state, Side side,
                                         std::span<const float> extensions);

/// The features of a start that depend on one of its cones alone; computed once for all pairs.
struct StartCone {
    Vertex cone;
    float behind;        ///< cones in the strip behind it, up to 3
    float continuation;  ///< how badly the best segment from it goes along the heading
    float predecessor;   ///< the same of the best one to it
    float density;
};
[[nodiscard]] StartCone start_cone(FrontMap& map, Vertex cone);
/// As the boundary on `side` sees the pair.
[[nodiscard]] StartFeatures start_features(FrontMap& map, const StartCone& own, const StartCone& other,
                                           Side side);

// What FrontJudge sees of the best lanes of a search, its contenders. Their probabilities are the softmax of
// their scores.

/// Of a cone of a lane, before what FrontCost saw of the move that added it (0 for the first pair).
inline constexpr std::size_t kConeFeatures = 8;
/// Of a whole lane.
inline constexpr std::size_t kWholeLaneColorFeatures = 4;  ///< the last ones
inline constexpr std::size_t kWholeLaneFeatures = 30 + kWholeLaneColorFeatures;
inline constexpr std::size_t kRightInputs = kConeFeatures + kExtendInputs;

[[nodiscard]] std::span<const FrontFeature, kConeFeatures> cone_feature_table();
[[nodiscard]] std::span<const FrontFeature, kWholeLaneFeatures> whole_lane_feature_table();

/// All tables under the keys that files of weights have for them, in the order of those files.
struct FrontFeatureList {
    std::string_view key;
    std::span<const FrontFeature> features;
    std::size_t colors;  ///< how many at their end are of colors
};
[[nodiscard]] std::array<FrontFeatureList, 6> front_feature_lists();

using RightInputs = std::array<float, kRightInputs>;
using WholeLaneFeatures = std::array<float, kWholeLaneFeatures>;

}  // namespace conelane
