#pragma once

#include "solvers/milp_solver.hpp"

#include <memory>

namespace conelane {

/// SYMPHONY's sequential branch and cut with its default cuts. It reports no bound before it has finished and
/// keeps its own clock, which it looks at between nodes; its granularity, below which a better point is not
/// looked for, is 1e-7. Each solve runs in a process of
/// its own, whose start is inside the time; where that aborts, the status is error.
[[nodiscard]] std::unique_ptr<MilpSolver> make_symphony_solver();

}  // namespace conelane
