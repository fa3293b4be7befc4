#include "solvers/lp_rounding_solver.hpp"

#include "solvers/deadline.hpp"
#include "solvers/path_pair_solver.hpp"
#include "solvers/relaxation/lp_relaxation.hpp"
#include "solvers/relaxation/rounding.hpp"

namespace conelane {
namespace {

class LpRounding : public RldSolver {
  public:
    RldReport solve(const LaneGraphProblem& problem, const SolveLimits& limits) override {
        const Deadline deadline(limits.time_limit_ms);
        const Stopwatch watch;
        const LpRelaxation relaxation = solve_lp_relaxation(problem, deadline);
        RldReport report;
        if (relaxation.infeasible) {
            report.status = SolveStatus::infeasible;
        } else if (!relaxation.bound) {
            report.status = SolveStatus::time_limit;
        } else {
            report = round_by_search(problem, relaxation.edge_values, *path_pair_,
                                     {deadline.remaining_ms(), limits.absolute_gap});
            report.bound = relaxation.bound;
        }
        report.rounds = 1;
        report.solve_ms = watch.elapsed_ms();
        return report;
    }

  private:
    std::unique_ptr<RldSolver> path_pair_ = make_path_pair_solver();
};

}  // namespace

std::unique_ptr<RldSolver> make_lp_rounding_solver() {
    return std::make_unique<LpRounding>();
}

}  // namespace conelane
