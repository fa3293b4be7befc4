#pragma once

#include "solvers/registry.hpp"
#include "tests/support/testing.hpp"

namespace conelane::tests {

/// A solver of the registry on one formulation.
struct SolverCase {
    const RldSolverEntry* entry;
    Formulation formulation;
    friend void PrintTo(const SolverCase& c, std::ostream* out) {
        *out << c.entry->name << ' ' << to_string(c.formulation);
    }
};

inline std::string case_name(const SolverCase& solver) {
    return conelane::case_name(std::string(solver.entry->name) + "_" +
                               std::string(to_string(solver.formulation)));
}

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
