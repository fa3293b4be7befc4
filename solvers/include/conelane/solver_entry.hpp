#pragma once

#include "conelane/formulation.hpp"
#include "conelane/rld_solver.hpp"

#include <cstddef>
#include <memory>
#include <optional>
#include <string_view>

namespace conelane {

/// A solver by its name.
struct RldSolverEntry {
    std::string_view name;
    std::string_view description;
    bool uses_formulation;  ///< false: the formulation is ignored
    bool exact;             ///< proves its optimum; false: a heuristic, whose best status is feasible
    std::unique_ptr<RldSolver> (*make)(Formulation formulation);
    std::optional<std::size_t> max_cones{};  ///< larger cone sets give status error; absent: no limit
};

}  // namespace conelane
