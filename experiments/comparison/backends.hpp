#pragma once

#include "experiments/scenes/annotated_scene.hpp"
#include "model/formulation.hpp"
#include "model/rld_parameters.hpp"
#include "solvers/solve_report.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace conelane::experiments {

/// A solver on a formulation, from nothing or from the lane graph of the scene before.
struct Backend {
    std::string solver;
    Formulation formulation = Formulation::tight;
    bool warm_start = false;

    /// "cbc/tight", "cbc/tight warm"; only the solver's name where it ignores formulations.
    [[nodiscard]] std::string label() const;
};

/// The exact solvers of this build that cope with any cone set, from nothing: each on the tight formulation,
/// CBC's full machinery on the printed one.
[[nodiscard]] std::vector<Backend> exact_backends();

/// The claim measured: all exact backends have the same optimum; they differ in time. Protocol: every backend
/// on the same cone sets, scene after scene in travel order, one thread, pinned; the time is from the scene
/// in memory to the lane graph in memory. A warm start is the last lane graph of the lap, its cones found
/// again by id.
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

/// Rows by size, backend and scene; scenes with fewer cones than a size are left out of it. Throws
/// InvalidInput where a backend's solver is not in this build.
[[nodiscard]] std::vector<BackendRow> backend_rows(std::span<const AnnotatedScene> scenes,
                                                   const BackendOptions& options);

/// A line per size and backend for a terminal. "differ": scenes whose proven optimum is more than 1e-6 off
/// the lowest that any backend proved.
[[nodiscard]] std::string backend_table(std::span<const BackendRow> rows);

/// A JSON object a line and row, with commit. Throws InputError where the file cannot be written.
void write_backend_rows(const std::filesystem::path& file, std::span<const BackendRow> rows);

}  // namespace conelane::experiments
