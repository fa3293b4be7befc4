#include "conelane/milp_solvers.hpp"

#include "solvers/milp/milp_solver.hpp"

namespace conelane {

std::span<const MilpBackend> milp_backends() {
    static const std::vector<MilpBackend> kBackends{
        kCbc,   kCbcMain, kClpBb,
#ifdef CONELANE_HAS_GLPK
        kGlpk,
#endif
#ifdef CONELANE_HAS_HIGHS
        kHighs,
#endif
    };
    return kBackends;
}

const MilpBackend* find_milp_backend(std::string_view name) {
    const auto backend =
        std::ranges::find(milp_backends(), name, [](const MilpBackend& b) { return b.entry.name; });
    return backend == milp_backends().end() ? nullptr : &*backend;
}

std::span<const RldSolverEntry> milp_solvers() {
    static const std::vector<RldSolverEntry> kEntries = [] {
        std::vector<RldSolverEntry> entries;
        for (const MilpBackend& backend : milp_backends()) entries.push_back(backend.entry);
        return entries;
    }();
    return kEntries;
}

}  // namespace conelane
