#pragma once

#include "conelane/lane_graph_problem.hpp"
#include "conelane/solve_report.hpp"

namespace conelane {

/// Anything that solves a lane-graph problem. An instance serves one thread. A solver overrides `run`; what
/// leaves through `solve` is checked, whoever wrote the search.
class RldSolver {
  public:
    virtual ~RldSolver() = default;

    /// The extent that `solve` wants its problems to be made with.
    [[nodiscard]] virtual EdgeExtent extent() const { return EdgeExtent::candidates; }

    /// Building the program is inside the time limit; a problem or a program that is too large (is_too_large,
    /// kMaxProgramEntries) gives status stopped by memory, invalid limits (see `invalidity`) and
    /// a backend that fails give status error and a message. `start` is a lane graph to start from, or
    /// nullptr: a hint that solvers may use as their first incumbent; one that is not feasible for the
    /// problem is dropped, a feasible one is in the report unless there is a cheaper lane graph, with status
    /// error too. Every answer is verified against the problem (model/answer_verification.hpp): one that
    /// breaks a constraint, a wrong objective, a bound above a known lane graph, an optimum or a proof of
    /// none that the start refutes give status error and a message. Throws nothing but std::bad_alloc.
    [[nodiscard]] RldReport solve(const LaneGraphProblem& problem, const SolveLimits& limits,
                                  const LaneGraph* start = nullptr);

  protected:
    /// The search: fills a report that is empty, with status error. Whatever it throws but std::bad_alloc
    /// becomes status error. Precondition: the limits are valid.
    virtual void run(const LaneGraphProblem& problem, const SolveLimits& limits, const LaneGraph* start,
                     RldReport& report) = 0;
};

}  // namespace conelane
