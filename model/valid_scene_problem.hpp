#pragma once

#include "conelane/lane_graph_problem.hpp"

namespace conelane {

/// `make_problem` with a deadline, for a scene that `validate` has accepted: it is not validated again.
/// Throws InvalidInput if the parameters are invalid, or if the difference of two coordinates is not
/// finite.
[[nodiscard]] LimitedProblem make_problem_of_valid_scene(const Scene& scene, const RldParameters& parameters,
                                                         EdgeExtent extent, const Deadline& deadline);
/// Without turns, conflicts, and the costs of shape and of learned costs.
[[nodiscard]] LimitedProblem make_edges_of_valid_scene(const Scene& scene, const RldParameters& parameters,
                                                       const Deadline& deadline);

}  // namespace conelane
