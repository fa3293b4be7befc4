#pragma once

#include "conelane/formulation.hpp"
#include "conelane/rld_solver.hpp"
#include "solvers/milp/milp_solver.hpp"

#include <memory>

namespace conelane {

/// Makes an RLD solver of a MILP solver: build the program, solve it, add the rows that the answer violates
/// ((5) and the pairing), and solve again until the answer is a lane graph.
[[nodiscard]] std::unique_ptr<RldSolver> make_milp_rld_solver(std::unique_ptr<MilpSolver> solver,
                                                              Formulation formulation);

}  // namespace conelane
