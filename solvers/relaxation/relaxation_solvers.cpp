#include "conelane/relaxation_solvers.hpp"

#include "solvers/relaxation/relaxation_solver.hpp"

#include <array>

namespace conelane {

std::span<const RldSolverEntry> relaxation_solvers() {
    static const std::array kSolvers{kLpRounding, kNlopt, kIpopt};
    return kSolvers;
}

}  // namespace conelane
