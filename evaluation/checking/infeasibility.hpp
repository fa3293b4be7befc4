#pragma once

#include "conelane/lane_graph.hpp"
#include "conelane/rld_parameters.hpp"
#include "conelane/scene.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace conelane {

/// What is known of a claim that a scene has no lane graph.
struct InfeasibilityVerdict {
    enum class Kind { confirmed, refuted, open };
    Kind kind = Kind::open;
    std::string by;                    ///< what decided
    std::optional<LaneGraph> witness;  ///< where it is refuted: a lane graph that the checker accepts
};

/// Decides the claim by, in this order: a search by the checker alone (see search_lane_graph), multipliers
/// that prove it and are recomputed from the scene alone (see verify_bound), and an exact solver other than
/// `claimant`, whose lane graph is held against the checker. Only the last step trusts a solver's word, and
/// the builder of the problem with it.
[[nodiscard]] InfeasibilityVerdict judge_infeasible(const Scene& scene, const RldParameters& parameters,
                                                    std::string_view claimant, double time_limit_ms);

}  // namespace conelane
