#pragma once

#include "evaluation/outside/outside_solver.hpp"

namespace conelane::experiments {

/// A solver on a formulation, from nothing or from the lane graph of the scene before.
struct Backend {
    std::string solver = {};  ///< of the registry, or the NAME of a program from outside
    Formulation formulation = Formulation::tight;
    bool warm_start = false;
    std::optional<OutsideDetector> outside{};
    bool all_rows = false;  ///< one program with all rows, instead of rows on demand

    /// "cbc/tight", "cbc/tight warm", "highs/tight whole"; only the solver's name where it ignores
    /// formulations.
    [[nodiscard]] std::string label() const;
    [[nodiscard]] bool uses_formulation() const;
    /// "tight rows, on demand; settings: tuned; no start": what a row of results says of the comparison.
    [[nodiscard]] std::string treatment() const;
    /// Whether the solver takes cone sets of this size, 0 for any (RldSolverEntry::max_cones).
    [[nodiscard]] bool takes(std::size_t cones) const;
};

/// Every exact solver of the registry, from nothing, those that use a formulation on the tight one.
[[nodiscard]] std::vector<Backend> exact_backends();

/// "SOLVER[/FORMULATION][/all-rows]", tight and rows on demand where it does not say; or the same after exec:
/// and before =COMMAND. Throws InvalidInput if the registry has no such exact solver, there is no such
/// formulation, or the solver uses none.
[[nodiscard]] Backend backend_of(std::string_view text);

/// A solver of a backend, ready to solve. Throws InvalidInput if the backend's solver is not in this
/// build, and as SolverProgram does.
class BackendSolver {
  public:
    explicit BackendSolver(const Backend& backend);

    /// Where the solver has a program, rows and columns are in an order drawn from SolveArguments::seed; rows
    /// that are added later keep their own order. A program from outside is told the seed, too.
    [[nodiscard]] RldSolver& solver() { return outside_ ? *outside_ : *inside_; }
    /// What the solver says that its own search took, of the last solve [ms]; absent if it says nothing.
    [[nodiscard]] std::optional<double> engine_ms() const;
    /// Name and version of the solver, and of its libraries; empty if it says nothing.
    [[nodiscard]] std::string version() const;
    /// Ends a program from outside; the largest resident memory that it had [bytes], absent of other solvers.
    [[nodiscard]] std::optional<std::size_t> end();

  private:
    std::string_view library_;
    std::unique_ptr<OutsideSolver> outside_;
    std::unique_ptr<RldSolver> inside_;
};

}  // namespace conelane::experiments
