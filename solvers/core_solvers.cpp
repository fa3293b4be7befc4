#include "conelane/core_solvers.hpp"

#include "solvers/exhaustive.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"

namespace conelane {
namespace {

constexpr RldSolverEntry kSolvers[]{
    {"path-pair", "exact branch and bound over pairs of paths", false, true,
     [](Formulation) { return make_path_pair_solver(); }},
    {"exhaustive", "every pair of paths, at most 9 cones", false, true,
     [](Formulation) { return make_exhaustive_solver(); }, kExhaustiveMostCones},
};

}  // namespace

std::span<const RldSolverEntry> core_solvers() {
    return kSolvers;
}

}  // namespace conelane
