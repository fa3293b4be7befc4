#include "solvers/relaxation/linear_relaxation.hpp"

#include "solvers/milp/detail/osi_program.hpp"

#include <coin/OsiClpSolverInterface.hpp>

namespace conelane {

std::optional<double> linear_relaxation_optimum(const BinaryProgram& program) {
    OsiClpSolverInterface lp;
    lp.messageHandler()->setLogLevel(0);
    lp.getModelPtr()->setLogLevel(0);
    detail::load_into(lp, program);
    lp.initialSolve();
    if (!lp.isProvenOptimal()) return std::nullopt;
    return lp.getObjValue();
}

}  // namespace conelane
