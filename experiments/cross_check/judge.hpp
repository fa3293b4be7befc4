#pragma once

#include "conelane/solve_report.hpp"
#include "experiments/cross_check/drawn_case.hpp"

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace conelane::experiments {

/// A solver that claims to be exact, used for one case after another.
struct CheckedSolver {
    std::string name;
    std::function<RldReport(const Scene&, const RldParameters&, const SolveArguments&)> solve;
    std::optional<std::size_t> max_cones = {};  ///< it does not get larger cone sets
    bool takes_starts = false;
};

/// The names of the exact solvers of this build.
[[nodiscard]] std::vector<std::string> exact_solver_names();

/// New solvers of these names. Throws InvalidInput if one is not an exact solver.
[[nodiscard]] std::vector<CheckedSolver> make_checked_solvers(std::span<const std::string> names,
                                                              Formulation formulation);

enum class CrossCheckOutcome {
    same_optimum,  ///< with the generous limit, all have proven the same optimum
    infeasible,    ///< with the generous limit, all have proven that there is no lane graph
    undecided,     ///< no contradiction, but with the generous limit not all have a proof
    differ,        ///< a contradiction or an error, see the findings
};
[[nodiscard]] std::string_view to_string(CrossCheckOutcome outcome);

struct CrossCheckVerdict {
    CrossCheckOutcome outcome = CrossCheckOutcome::undecided;
    std::optional<double> objective;    ///< of the first solver, if it is proven optimal
    std::vector<std::string> findings;  ///< a sentence each
    bool certified = false;             ///< the proof was repeated in rational arithmetic
    std::size_t tight_answers = 0;
    std::size_t tight_proofs = 0;  ///< claims among these of optimal or infeasible that are not refuted
};

/// Runs each solver with the generous limit, then with the case's tight limit, and from starts: its own
/// answer (with both limits); with the tight limit also the answer of another solver, an answer without its
/// last edge, random edges, and an answer with an edge of a cone that is missing. Compares every claim with
/// all others, whatever its solver, limit or start:
/// - each status has the right content: a lane graph only with `optimal` and `feasible`; with `optimal`, a
///   bound equal to the objective;
/// - the independent checker accepts each lane graph and its objective;
/// - an answer from a feasible start is a lane graph that costs no more;
/// - no bound is above any accepted lane graph's objective by more than 1e-6 of max(1, |objective|), so no
///   objective is below what was proven; `infeasible` counts as an infinite bound;
/// - if all say `infeasible`, a search by the checker alone finds no lane graph within 20 ms;
/// - the proof of path-pair, for up to 12 cones, can be repeated in rational arithmetic from the scene alone,
///   within a few thousand steps.
[[nodiscard]] CrossCheckVerdict judge(const CrossCheckCase& drawn, std::span<const CheckedSolver> solvers,
                                      double time_limit_ms);

}  // namespace conelane::experiments
