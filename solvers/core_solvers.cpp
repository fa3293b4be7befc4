#include "conelane/core_solvers.hpp"

#include "solvers/core_entries.hpp"

#include <array>

namespace conelane {

std::span<const RldSolverEntry> core_solvers() {
    static const std::array kSolvers{kPathPair, kExhaustive};
    return kSolvers;
}

}  // namespace conelane
