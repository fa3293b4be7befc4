#include "solvers/registry.hpp"

#include "conelane/milp_solvers.hpp"
#include "conelane/relaxation_solvers.hpp"

namespace conelane {

std::span<const RldSolverEntry> rld_solvers() {
    static const std::vector<RldSolverEntry> kSolvers = [] {
        std::vector<RldSolverEntry> all;
        for (const std::span<const RldSolverEntry> part :
             {core_solvers(), milp_solvers(), relaxation_solvers()})
            all.insert(all.end(), part.begin(), part.end());
        return all;
    }();
    return kSolvers;
}

const RldSolverEntry* find_rld_solver(std::string_view name) {
    const auto entry = std::ranges::find(rld_solvers(), name, &RldSolverEntry::name);
    return entry == rld_solvers().end() ? nullptr : &*entry;
}

}  // namespace conelane
