#pragma once

#include "conelane/formulation.hpp"
#include "solvers/registry.hpp"
#include "tests/support/print_status.hpp"

#include <ostream>
#include <vector>

namespace conelane::tests {

/// A solver of the registry on one formulation.
struct SolverCase {
    const RldSolverEntry* entry;
    Formulation formulation;
    friend void PrintTo(const SolverCase& c, std::ostream* out) {
        *out << c.entry->name << ' ' << to_string(c.formulation);
    }
};

/// All solvers, on every formulation that they use.
inline std::vector<SolverCase> solver_cases() {
    std::vector<SolverCase> all;
    for (const RldSolverEntry& entry : rld_solvers()) {
        all.push_back({&entry, Formulation::tight});
        if (entry.has(SolverTrait::uses_formulation)) all.push_back({&entry, Formulation::paper});
    }
    return all;
}

}  // namespace conelane::tests
