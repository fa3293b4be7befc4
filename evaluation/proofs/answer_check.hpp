#pragma once

#include "conelane/lane.hpp"
#include "conelane/lane_graph.hpp"
#include "conelane/rld_parameters.hpp"
#include "conelane/scene.hpp"
#include "evaluation/formats/lane_file.hpp"

#include <optional>

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

}  // namespace conelane
