#pragma once

#include "conelane/rld_parameters.hpp"
#include "conelane/solve_report.hpp"
#include "evaluation/scoring/solver_measures.hpp"
#include "evaluation/world/annotated_scene.hpp"
#include "experiments/comparison/answer_errors.hpp"
#include "experiments/studies/backend.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace conelane::experiments {

class Study;

/// Every exact solver of the registry, and programs from outside, on the same cone sets.
[[nodiscard]] std::unique_ptr<Study> make_backends_study();

/// A size that means all cones of the scene.
inline constexpr std::size_t kAllVisible = 0;

struct BackendOptions {
    std::vector<Backend> backends;
    std::vector<std::size_t> sizes{12, 30};  ///< may contain kAllVisible
    RldParameters parameters;
    double time_limit_ms = 1000.0;  ///< of a solve
    std::optional<std::size_t>
        limit;  ///< largest number of scenes of each size, evenly spread; all if absent
    /// Number of additional runs of each scene without a start, with its cones, and rows and columns of the
    /// program (see BackendSolver), in other orders.
    std::size_t permutations = 0;
    std::uint64_t seed = 1;  ///< of the permutations
    /// Limits below the time limit under which each scene is solved again without a start, ascending: for the
    /// gap over time [ms].
    std::vector<double> gap_limits_ms;
};

/// One solve.
struct BackendRow {
    const AnnotatedScene* scene = nullptr;
    std::size_t cones = 0;
    Backend backend;
    SolveStatus status = SolveStatus::error;  ///< also error if the independent checker objects
    std::string message;
    std::optional<double> objective;
    std::int64_t nodes = 0;
    double latency_ms = 0.0;
    std::optional<double> bound{};
    std::optional<double> engine_ms{};  ///< measured by the solver itself
    int rounds = 0;                     ///< number of times the program was solved
    std::size_t size = 0;               ///< the requested size: `cones`, or kAllVisible
    std::size_t permutation = 0;        ///< 0: original order
    /// A claim that the checked lane graph of another backend on the same cones contradicts: `message` names
    /// it. The status remains the claimed one.
    bool refuted = false;
    std::optional<StopReason> stopped_by{};
    std::vector<Knowledge> steps{};  ///< by the limits for the gap, and at the end
};

/// All solves of one backend at one size.
struct BackendBlock {
    std::size_t size = 0;
    std::string backend;
    std::string version;
    /// Growth of this process, or the largest process of a program from outside.
    std::optional<std::size_t> peak_bytes;
    double reference_ms = 0.0;  ///< ReferenceProblem just before
};

struct BackendResults {
    std::vector<BackendRow> rows;  ///< by size, backend, scene and permutation
    std::vector<BackendBlock> blocks;
};

/// For each size, scenes with fewer cones are left out, and so are backends whose solver does not accept that
/// size (RldSolverEntry::max_cones). Claims that another row refutes are marked. Throws InvalidInput if a
/// backend's solver is not in this build.
[[nodiscard]] BackendResults backend_results(std::span<const AnnotatedScene> scenes,
                                             const BackendOptions& options);
/// Its rows.
[[nodiscard]] std::vector<BackendRow> backend_rows(std::span<const AnnotatedScene> scenes,
                                                   const BackendOptions& options);

/// Marks each claim that a checked lane graph of another row of the same scene and size refutes by more than
/// kObjectiveTolerance, relative to its size if that is above 1: an optimum or a bound above it, or
/// infeasibility. `backend_results` calls it.
void mark_refuted_claims(std::span<BackendRow> rows);

/// The answers by backend and size, and the errors among them; a refuted claim is one.
[[nodiscard]] AnswerErrors errors_among(std::span<const BackendRow> rows);

/// A line for each size and backend for a terminal: errors and refuted claims in every order, all else for
/// the scenes in their original order.
[[nodiscard]] std::string backend_table(std::span<const BackendRow> rows);

/// "12", or "all" for kAllVisible.
[[nodiscard]] std::string size_name(std::size_t size);

}  // namespace conelane::experiments
