#include "solvers/milp_rld_solver.hpp"

#include "model/lane_graph_model.hpp"
#include "solvers/deadline.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace conelane {
namespace {

class MilpRldSolver : public RldSolver {
  public:
    MilpRldSolver(std::unique_ptr<MilpSolver> solver, Formulation formulation)
        : solver_(std::move(solver)), formulation_(formulation) {}

    EdgeExtent extent() const override { return parts(formulation_).extent; }

    RldReport solve(const LaneGraphProblem& problem, const SolveLimits& limits) override {
        const Deadline deadline(limits.time_limit_ms);
        const Stopwatch build_watch;
        RldReport report;
        if (problem.edges.empty()) {
            report.status = SolveStatus::infeasible;
            return report;
        }
        const LaneGraphModel model(problem, formulation_);
        const std::unique_ptr<MilpSession> session = solver_->load(model.program());
        report.build_ms = build_watch.elapsed_ms();

        const Stopwatch solve_watch;
        solve_and_separate(problem, model, *session, limits, deadline, report);
        report.solve_ms = solve_watch.elapsed_ms();
        return report;
    }

  private:
    static void solve_and_separate(const LaneGraphProblem& problem, const LaneGraphModel& model,
                                   MilpSession& session, const SolveLimits& limits, const Deadline& deadline,
                                   RldReport& report) {
        while (true) {
            const MilpLimits remaining{deadline.remaining_ms(), limits.absolute_gap};
            if (remaining.time_limit_ms <= 0.0) {
                report.status = SolveStatus::time_limit;
                return;
            }
            const MilpReport round = session.solve(remaining);
            ++report.rounds;
            report.nodes += round.nodes;
            report.status = round.status;
            report.message = round.message;
            // Rows only ever tighten the program: every round's bound holds for the problem.
            if (round.bound) report.bound = std::max(report.bound.value_or(*round.bound), *round.bound);
            if (round.point.empty()) return;

            const std::vector<ProgramRow> violated = model.separate(round.point);
            if (violated.empty()) {
                report.lane_graph = model.decode(round.point);
                report.objective = objective(problem, *report.lane_graph);
                // A bound comes from the solver's own sums: it may exceed the objective by rounding only.
                if (report.bound) report.bound = std::min(*report.bound, *report.objective);
                return;
            }
            session.add_rows(violated);
        }
    }

    std::unique_ptr<MilpSolver> solver_;
    Formulation formulation_;
};

}  // namespace

std::unique_ptr<RldSolver> make_milp_rld_solver(std::unique_ptr<MilpSolver> solver, Formulation formulation) {
    return std::make_unique<MilpRldSolver>(std::move(solver), formulation);
}

}  // namespace conelane
