#pragma once

#include "conelane/lane_graph_problem.hpp"

#include <functional>

namespace conelane {

/// `make_problem` with a deadline, for a scene that `validate` has accepted: it is not validated again.
/// Throws InvalidInput if the parameters are invalid, or if the difference of two coordinates is not
/// finite.
[[nodiscard]] LimitedProblem make_problem_of_valid_scene(const Scene& scene, const RldParameters& parameters,
                                                         EdgeExtent extent, const Deadline& deadline);
/// Without turns, conflicts, and the costs of shape and of learned costs.
[[nodiscard]] LimitedProblem make_edges_of_valid_scene(const Scene& scene, const RldParameters& parameters,
                                                       const Deadline& deadline);

/// By cone: the distance of its k-th nearest other cone; infinite if there is none within max_m, or k is 0.
/// A cone j is among the k nearest of i if fewer than k cones are nearer to i. `stop` is asked for each cone.
[[nodiscard]] std::vector<double> reach_of_nearest(const Scene& scene, double k, double max_m,
                                                   const std::function<bool()>& stop = {});

}  // namespace conelane
