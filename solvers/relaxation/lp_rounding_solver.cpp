#include "solvers/relaxation/lp_rounding_solver.hpp"

#include "model/deadline.hpp"
#include "solvers/relaxation/relaxation_solver.hpp"

#include <vector>

namespace conelane {

std::unique_ptr<RldSolver> make_lp_rounding_solver() {
    return make_relaxation_solver([](const LaneGraphProblem& /*problem*/, const std::vector<double>& linear,
                                     const Deadline& /*deadline*/) { return linear; });
}

}  // namespace conelane
