#include "solvers/relaxation/relaxation_solver.hpp"

#include "model/deadline.hpp"
#include "solvers/path_pair_solver.hpp"
#include "solvers/relaxation/lp_relaxation.hpp"
#include "solvers/relaxation/rounding.hpp"

#include <utility>

namespace conelane {
namespace {

class RelaxationSolver : public RldSolver {
  public:
    explicit RelaxationSolver(Relax relax) : relax_(std::move(relax)) {}

  private:
    void run(const LaneGraphProblem& problem, const SolveLimits& limits, const LaneGraph* /*start*/,
             RldReport& report) override {
        const Deadline deadline(limits.time_limit_ms);
        const Stopwatch watch;
        relax_and_round(problem, limits, deadline, report);
        report.rounds = 1;
        report.solve_ms = watch.elapsed_ms();
    }

    void relax_and_round(const LaneGraphProblem& problem, const SolveLimits& limits, const Deadline& deadline,
                         RldReport& report) {
        const LpRelaxation linear = solve_lp_relaxation(problem, deadline);
        report.bound = linear.bound;
        if (!linear.bound) {
            report.status = linear.infeasible ? SolveStatus::infeasible : SolveStatus::stopped;
            report.stopped_by = linear.stopped_by;
            return;
        }
        const auto values = relax_(problem, linear.edge_values, deadline);
        if (!values) {
            report.status = SolveStatus::stopped;
            report.stopped_by = StopReason::time;
            return;
        }
        report =
            round_by_search(problem, *values, *path_pair_, {deadline.remaining_ms(), limits.absolute_gap});
        report.bound = linear.bound;
    }

    Relax relax_;
    std::unique_ptr<RldSolver> path_pair_ = make_path_pair_solver();
};

}  // namespace

std::unique_ptr<RldSolver> make_relaxation_solver(Relax relax) {
    return std::make_unique<RelaxationSolver>(std::move(relax));
}

}  // namespace conelane
