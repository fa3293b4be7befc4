#include "conelane/relaxation_solvers.hpp"

#include "solvers/relaxation/ipopt_relaxation.hpp"
#include "solvers/relaxation/lp_rounding_solver.hpp"
#include "solvers/relaxation/nlopt_relaxation.hpp"

namespace conelane {
namespace {

constexpr RldSolverEntry kSolvers[]{
    {"lp-rounding", "Clp's relaxation, rounded; no proof", false, false,
     [](Formulation) { return make_lp_rounding_solver(); }},
    {"nlopt", "NLopt on the relaxation with products, rounded; no proof", false, false,
     [](Formulation) { return make_nlopt_relaxation_solver(); }},
    {"ipopt", "Ipopt on the relaxation with products, rounded; no proof", false, false,
     [](Formulation) { return make_ipopt_relaxation_solver(); }},
};

}  // namespace

std::span<const RldSolverEntry> relaxation_solvers() {
    return kSolvers;
}

}  // namespace conelane
