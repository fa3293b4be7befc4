#pragma once

#include "graph_search/front/front_feature_schema.hpp"
#include "graph_search/front/front_state.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace conelane {

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

}  // namespace conelane
