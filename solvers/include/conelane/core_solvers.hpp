#pragma once

#include "conelane/formulation.hpp"
#include "conelane/rld_solver.hpp"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

namespace conelane {

/// Properties that not every solver has, joined by |.
enum class SolverTrait : unsigned {
    none = 0,
    exact = 1U << 0U,               ///< proves its optimum; others are heuristics and never claim one
    uses_formulation = 1U << 1U,    ///< others ignore the formulation
    suits_paper = 1U << 2U,         ///< fast with Formulation::paper and 12 cones; others take seconds
    reads_time_of_day = 1U << 3U,   ///< setting the system clock during a solve changes its time limit
    refuses_huge_costs = 1U << 4U,  ///< status error and a message from costs of 1e25 on, with Clp 1e14
    tuned = 1U << 5U,               ///< its library has other settings than the default ones
};
[[nodiscard]] constexpr SolverTrait operator|(SolverTrait a, SolverTrait b) {
    return SolverTrait{static_cast<unsigned>(a) | static_cast<unsigned>(b)};
}

/// A solver by its name. An entry is defined in the .cpp file of its solver.
struct RldSolverEntry {
    std::string_view name;
    std::string_view description;
    SolverTrait traits = SolverTrait::none;
    std::unique_ptr<RldSolver> (*make)(Formulation formulation) = nullptr;
    std::optional<std::size_t> max_cones{};  ///< larger cone sets give status error; absent: no limit
    std::string_view library{};              ///< what searches, with its version; empty: conelane itself

    [[nodiscard]] constexpr bool has(SolverTrait trait) const {
        return (static_cast<unsigned>(traits) & static_cast<unsigned>(trait)) != 0;
    }
};

/// The solvers of the core, which need no other library.
[[nodiscard]] std::span<const RldSolverEntry> core_solvers();

}  // namespace conelane
