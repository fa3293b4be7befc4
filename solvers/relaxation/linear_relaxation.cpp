#include "solvers/relaxation/linear_relaxation.hpp"

#include "solvers/milp/detail/osi_program.hpp"

#include <cmath>

#include <coin/OsiClpSolverInterface.hpp>

namespace conelane {

std::optional<LinearRelaxation> linear_relaxation(const BinaryProgram& program) {
    OsiClpSolverInterface lp;
    lp.messageHandler()->setLogLevel(0);
    lp.getModelPtr()->setLogLevel(0);
    detail::load_into(lp, program);
    lp.initialSolve();
    if (!lp.isProvenOptimal()) return std::nullopt;
    LinearRelaxation relaxation{lp.getObjValue(), true};
    for (std::size_t c = 0; c < program.columns.size(); ++c) {
        const double value = lp.getColSolution()[c];
        if (program.columns[c].integer && std::abs(value - std::round(value)) > 1e-6)
            relaxation.is_integral = false;
    }
    return relaxation;
}

}  // namespace conelane
