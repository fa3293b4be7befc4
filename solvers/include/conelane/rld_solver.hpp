#pragma once

#include "conelane/lane_graph_problem.hpp"
#include "conelane/solve_report.hpp"

namespace conelane {

/// Solves lane-graph problems. An instance serves one thread. A solver overrides `run`; `solve` verifies
/// every answer.
class RldSolver {
  public:
    virtual ~RldSolver() = default;

    /// The extent that problems for `solve` have to be made with.
    [[nodiscard]] virtual EdgeExtent extent() const { return EdgeExtent::candidates; }

    /// The time limit includes building the program. A problem that is_too_large, or a program of more than
    /// 4'000'000 entries, gives status stopped by memory. Invalid limits (see `invalidity`), a failing
    /// backend and more cones than RldSolverEntry::max_cones give status error and a message.
    ///
    /// Every answer is verified against the problem (model/answer_verification.hpp), to 1e-6 max(1, |cost|).
    /// A broken constraint, a wrong objective, a bound above a known lane graph, and an optimum or
    /// infeasibility that the start refutes give status error and a message. Throws only std::bad_alloc.
    [[nodiscard]] RldReport solve(const LaneGraphProblem& problem, const SolveArguments& arguments);

  protected:
    /// The search: fills an empty report, whose status is error. Any exception but std::bad_alloc becomes
    /// status error. Precondition: the limits are valid.
    virtual void run(const LaneGraphProblem& problem, const SolveArguments& arguments, RldReport& report) = 0;
};

}  // namespace conelane
