#pragma once

#include "conelane/solve_scene.hpp"

namespace conelane {

/// `solve_scene` for a scene that `validate` has accepted: it is not validated again.
[[nodiscard]] SolvedScene solve_valid_scene(RldSolver& solver, const Scene& scene,
                                            const RldParameters& parameters, const SolveArguments& arguments);

}  // namespace conelane
