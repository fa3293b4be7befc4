#pragma once

#include "conelane/formulation.hpp"
#include "conelane/rld_solver.hpp"
#include "solvers/milp/milp_solver.hpp"

#include <memory>

namespace conelane {

/// Makes a MILP solver an RLD solver: build the program, solve, separate the rows that the answer violates
/// ((5) and the pairing), solve again until it is a lane graph.
[[nodiscard]] std::unique_ptr<RldSolver> make_milp_rld_solver(std::unique_ptr<MilpSolver> solver,
                                                              Formulation formulation);

}  // namespace conelane
