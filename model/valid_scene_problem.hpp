#pragma once

#include "conelane/lane_graph_problem.hpp"

namespace conelane {

/// `make_problem` with a deadline for a scene that `validate` has accepted, which is not checked again.
/// Throws InvalidInput where the parameters are not valid, or where cones are so far from the car that their
/// distance is no finite number.
[[nodiscard]] LimitedProblem make_problem_of_valid_scene(const Scene& scene, const RldParameters& parameters,
                                                         EdgeExtent extent, const Deadline& deadline);

}  // namespace conelane
