#pragma once

#include "conelane/formulation.hpp"
#include "conelane/rld_parameters.hpp"
#include "conelane/solve_report.hpp"
#include "evaluation/scenes/annotated_scene.hpp"
#include "experiments/comparison/answer_errors.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace conelane::experiments {

class Study;

/// Every exact solver of the registry on the same cone sets.
[[nodiscard]] std::unique_ptr<Study> make_backends_study();

/// A solver on a formulation, from nothing or from the lane graph of the scene before.
struct Backend {
    std::string solver;
    Formulation formulation = Formulation::tight;
    bool warm_start = false;

    /// "cbc/tight", "cbc/tight warm"; only the solver's name where it ignores formulations.
    [[nodiscard]] std::string label() const;
};

/// Every exact solver of the registry, from nothing, those that use a formulation on the tight one.
[[nodiscard]] std::vector<Backend> exact_backends();

/// "SOLVER" or "SOLVER/FORMULATION", tight where none is named. Throws InvalidInput where the registry has no
/// such exact solver, there is no such formulation, or the solver uses none.
[[nodiscard]] Backend backend_of(std::string_view name);

struct BackendOptions {
    std::vector<Backend> backends;
    std::vector<std::size_t> sizes{12, 30};
    RldParameters parameters;
    double time_limit_ms = 1000.0;  ///< a solve
};

/// One solve.
struct BackendRow {
    const AnnotatedScene* scene = nullptr;
    std::size_t cones = 0;
    Backend backend;
    SolveStatus status = SolveStatus::error;  ///< error also where the independent checker objects
    std::string message;
    std::optional<double> objective;
    std::int64_t nodes = 0;
    double latency_ms = 0.0;
};

/// Rows by size, backend and scene. For each size, scenes with fewer cones are left out, and so are backends
/// whose solver takes no cone set of that size (RldSolverEntry::max_cones). Throws InvalidInput where a
/// backend's solver is not in this build.
[[nodiscard]] std::vector<BackendRow> backend_rows(std::span<const AnnotatedScene> scenes,
                                                   const BackendOptions& options);

/// The answers by backend and size, and the errors among them.
[[nodiscard]] AnswerErrors errors_among(std::span<const BackendRow> rows);

/// A line per size and backend for a terminal. "differ": scenes whose proven optimum is more than
/// kObjectiveTolerance above the lowest that any backend proved.
[[nodiscard]] std::string backend_table(std::span<const BackendRow> rows);

}  // namespace conelane::experiments
