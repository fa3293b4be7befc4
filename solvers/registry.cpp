#include "solvers/registry.hpp"

#include "solvers/cbc_solver.hpp"
#include "solvers/exhaustive.hpp"
#include "solvers/milp_rld_solver.hpp"
#include "solvers/path_pair_solver.hpp"

#include <algorithm>
#include <array>

namespace conelane {
namespace {

constexpr std::array<RldSolverEntry, 3> kSolvers{{
    {"cbc", "CBC in process, CbcModel's branch and bound", true,
     [](Formulation formulation) { return make_milp_rld_solver(make_cbc_solver(), formulation); }},
    {"exhaustive", "every pair of paths, at most 9 cones", false,
     [](Formulation) { return make_exhaustive_solver(); }},
    {"path-pair", "exact branch and bound over pairs of paths", false,
     [](Formulation) { return make_path_pair_solver(); }},
}};

}  // namespace

std::span<const RldSolverEntry> rld_solvers() {
    return kSolvers;
}

const RldSolverEntry* find_rld_solver(std::string_view name) {
    const auto entry = std::ranges::find(kSolvers, name, &RldSolverEntry::name);
    return entry == kSolvers.end() ? nullptr : &*entry;
}

}  // namespace conelane
