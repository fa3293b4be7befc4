#pragma once

#include "conelane/lane.hpp"
#include "conelane/lane_graph.hpp"
#include "conelane/rld_parameters.hpp"
#include "conelane/scene.hpp"
#include "evaluation/formats/lane_file.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace conelane {

/// The edges between consecutive cones of each boundary; of a closed lane also those from last to first.
/// Nothing if the lane names a cone that is not in the scene, or one twice in a row.
[[nodiscard]] std::optional<LaneGraph> lane_graph_of(const Lane& lane, const Scene& scene);

/// Checks the answer of an RLD detector by the independent checker: every constraint, the stated objective,
/// bound and optimality. `seen`: the scene among whose cones the lane was found. If the lane was cut, the
/// lane before the cut is checked, and the cut must give the lane. An answer that passes is marked as
/// checked; another one gets status error with the checker's first objection as its message. A record without
/// a lane stays unchanged.
void check_answer(LaneRecord& record, const Scene& seen, const RldParameters& parameters);

/// The verdict on a claim that somebody else made about a scene.
struct ClaimVerdict {
    enum class Kind { proven, unverified, wrong };
    Kind kind = Kind::unverified;
    std::string by;                    ///< the step that decided, or the solver that was asked last
    std::optional<LaneGraph> witness;  ///< if it is wrong: a lane graph that the checker accepts
    std::optional<double> objective;   ///< of the witness
};

/// Decides the claim that no lane graph of the scene has an objective below `bound`, by 1e-6 of max(1,
/// |bound|); infinity claims that there is no lane graph. In this order:
/// - for infinity, a search by the checker (see search_lane_graph);
/// - multipliers that prove it, recomputed from the scene (see verify_bound);
/// - if the claimant is path-pair, a certificate of its whole search, repeated in rational arithmetic (see
///   verify_search);
/// - an exact solver other than `claimant`, whose lane graph the checker judges.
/// Only the last step trusts a solver and the builder of the problem.
[[nodiscard]] ClaimVerdict judge_bound(const Scene& scene, const RldParameters& parameters, double bound,
                                       std::string_view claimant, double time_limit_ms);

}  // namespace conelane
