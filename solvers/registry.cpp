#include "solvers/registry.hpp"

#include "solvers/cbc_main_solver.hpp"
#include "solvers/cbc_solver.hpp"
#include "solvers/clp_bb_solver.hpp"
#include "solvers/exhaustive.hpp"
#include "solvers/glpk_solver.hpp"
#include "solvers/ipopt_relaxation.hpp"
#include "solvers/lp_rounding_solver.hpp"
#include "solvers/milp_rld_solver.hpp"
#include "solvers/nlopt_relaxation.hpp"
#include "solvers/path_pair_solver.hpp"
#include "solvers/symphony_solver.hpp"

#include <algorithm>
#include <iterator>

namespace conelane {
namespace {

template <std::unique_ptr<MilpSolver> (*make)()>
std::unique_ptr<RldSolver> make_milp(Formulation formulation) {
    return make_milp_rld_solver(make(), formulation);
}

constexpr RldSolverEntry kSolvers[]{
    {"cbc", "CBC in process, CbcModel's branch and bound", true, true, make_milp<make_cbc_solver>},
    {"cbc-main", "CBC's full machinery, one at a time", true, true, make_milp<make_cbc_main_solver>},
    {"clp-bb", "depth-first branch and bound on a warm Clp", true, true, make_milp<make_clp_bb_solver>},
#ifdef CONELANE_HAS_GLPK
    {"glpk", "GLPK's branch and bound", true, true, make_milp<make_glpk_solver>},
#endif
#ifdef CONELANE_HAS_SYMPHONY
    {"symphony", "SYMPHONY's branch and cut, in a process of its own", true, true,
     make_milp<make_symphony_solver>},
#endif
    {"exhaustive", "every pair of paths, at most 9 cones", false, true,
     [](Formulation) { return make_exhaustive_solver(); }, kExhaustiveMostCones},
    {"path-pair", "exact branch and bound over pairs of paths", false, true,
     [](Formulation) { return make_path_pair_solver(); }},
    {"lp-rounding", "Clp's relaxation, rounded; no proof", false, false,
     [](Formulation) { return make_lp_rounding_solver(); }},
    {"nlopt", "NLopt on the relaxation with products, rounded; no proof", false, false,
     [](Formulation) { return make_nlopt_relaxation_solver(); }},
#ifdef CONELANE_HAS_IPOPT
    {"ipopt", "Ipopt on the relaxation with products, rounded; no proof", false, false,
     [](Formulation) { return make_ipopt_relaxation_solver(); }},
#endif
};

}  // namespace

std::span<const RldSolverEntry> rld_solvers() {
    return kSolvers;
}

const RldSolverEntry* find_rld_solver(std::string_view name) {
    const auto entry = std::ranges::find(kSolvers, name, &RldSolverEntry::name);
    return entry == std::end(kSolvers) ? nullptr : &*entry;
}

}  // namespace conelane
