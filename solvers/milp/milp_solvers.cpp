#include "conelane/milp_solvers.hpp"

#include "solvers/milp/cbc_main_solver.hpp"
#include "solvers/milp/cbc_solver.hpp"
#include "solvers/milp/clp_bb_solver.hpp"
#include "solvers/milp/glpk_solver.hpp"
#include "solvers/milp/milp_rld_solver.hpp"

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
};

}  // namespace

std::span<const RldSolverEntry> milp_solvers() {
    return kSolvers;
}

}  // namespace conelane
