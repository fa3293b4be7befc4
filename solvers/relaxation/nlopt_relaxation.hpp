#pragma once

#include "conelane/rld_solver.hpp"

#include <memory>

namespace conelane {

/// A point near a local minimum of EdgeRelaxation by NLopt, from the linear relaxation's solution, rounded by
/// a search among the edges that it favours. NLopt's augmented Lagrangian (AUGLAG) moves the rows into the
/// objective, and the method of moving asymptotes (LD_MMA) minimises it in the box; their cost is that of the
/// entries of the rows. Other choices on 20 scenes a size: SLSQP is as good at n = 12 and takes eight times
/// as long at n = 30, because its quadratic program is dense; LD_MMA with the inequalities as its constraints
/// takes seconds, with a dual variable for each of hundreds of rows; LD_LBFGS under AUGLAG is as fast and
/// ends in worse points; LD_CCSAQ under it is worse at n = 12 and 20, as good at 30. Of the points evaluated,
/// the one with the least violation counts; within the tolerance, the cheapest. The bound is the linear
/// relaxation's; status feasible at best, infeasible if the linear relaxation is.
[[nodiscard]] std::unique_ptr<RldSolver> make_nlopt_relaxation_solver();

}  // namespace conelane
