#pragma once

#include "conelane/lane_graph.hpp"
#include "conelane/rld_parameters.hpp"
#include "conelane/scene.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace conelane {

/// The verdict on a claim that a scene has no lane graph.
struct InfeasibilityVerdict {
    enum class Kind { confirmed, refuted, open };
    Kind kind = Kind::open;
    std::string by;                    ///< the step that decided
    std::optional<LaneGraph> witness;  ///< if it is refuted: a lane graph that the checker accepts
};

/// Decides the claim by, in this order: a search by the checker (see search_lane_graph); multipliers that
/// prove it, recomputed from the scene (see verify_bound); and an exact solver other than `claimant`, whose
/// lane graph the checker judges. Only the last step trusts a solver and the builder of the problem.
[[nodiscard]] InfeasibilityVerdict judge_infeasible(const Scene& scene, const RldParameters& parameters,
                                                    std::string_view claimant, double time_limit_ms);

}  // namespace conelane
