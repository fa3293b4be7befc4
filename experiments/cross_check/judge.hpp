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

/// A solver that claims to be exact, for one case after the other.
struct CheckedSolver {
    std::string name;
    std::function<RldReport(const Scene&, const RldParameters&, double time_limit_ms)> solve;
    std::optional<std::size_t> max_cones{};  ///< it is not asked about more
    /// The same from a start; it is not asked from starts where this is empty.
    std::function<RldReport(const Scene&, const RldParameters&, double time_limit_ms, const LaneGraph& start)>
        solve_from = {};
};

/// The names of the exact solvers of this build.
[[nodiscard]] std::vector<std::string> exact_solver_names();

/// New solvers of these names. Throws InvalidInput where one is no exact solver.
[[nodiscard]] std::vector<CheckedSolver> make_checked_solvers(std::span<const std::string> names,
                                                              Formulation formulation);

enum class CrossCheckOutcome {
    same_optimum,  ///< at the generous limit all have proven one, and it is the same
    infeasible,    ///< there all have proven that there is none
    undecided,     ///< nothing contradicts, but not all have proven theirs there
    differ,        ///< something is wrong, see the findings
};
[[nodiscard]] std::string_view to_string(CrossCheckOutcome outcome);

struct CrossCheckVerdict {
    CrossCheckOutcome outcome = CrossCheckOutcome::undecided;
    std::optional<double> objective;    ///< of the first solver, where it is proven optimal
    std::vector<std::string> findings;  ///< a sentence each
    bool certified = false;             ///< the proof was repeated in rational arithmetic
    std::size_t tight_answers = 0;
    std::size_t tight_proofs = 0;  ///< of these claimed optimal or infeasible, and not refuted
};

/// Asks each solver under the generous limit, then each again under the case's tight limit, and from
/// starts: its own answer under both limits, and under the tight one the answer of another, an answer without
/// its last edge, edges drawn at random, and an answer with an edge of a cone that is gone. Holds everything
/// claimed against everything known, whoever said it, under which limit and from which start:
/// - a status comes with what belongs to it: a lane graph with `optimal` and `feasible` alone, a bound that
///   meets the objective with `optimal`;
/// - the independent checker accepts each lane graph and its objective;
/// - an answer from a feasible start is a lane graph that costs no more;
/// - no bound is above any accepted lane graph's objective by more than 1e-6 of max(1, |objective|), so no
///   objective is below what was proven; `infeasible` counts as an infinite bound;
/// - where all say `infeasible`, a search by the checker alone finds no lane graph in the 20 ms it has;
/// - the proof of path-pair, of up to 12 cones, can be repeated in rational arithmetic from the scene alone,
///   as far as a few thousand steps get.
[[nodiscard]] CrossCheckVerdict judge(const CrossCheckCase& drawn, std::span<const CheckedSolver> solvers,
                                      double time_limit_ms);

}  // namespace conelane::experiments
