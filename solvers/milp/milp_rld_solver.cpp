#include "model/connecting_flow.hpp"
#include "model/lane_graph_model.hpp"
#include "solvers/milp/milp_solver.hpp"

namespace conelane {
namespace {

class MilpRldSolver : public RldSolver {
  public:
    MilpRldSolver(MilpSolver solver, ProgramForm form) : solver_(std::move(solver)), form_(form) {}

    EdgeExtent extent() const override { return parts(form_.formulation).extent; }

  private:
    void run(const LaneGraphProblem& problem, const SolveArguments& arguments, RldReport& report) override {
        const Deadline deadline(arguments.limits.time_limit_ms);
        if (problem.edges.empty()) {
            report.status = SolveStatus::infeasible;
            return;
        }
        const Stopwatch build_watch;
        const std::unique_ptr<MilpSession> session = load(problem, arguments.seed, deadline, report);
        report.build_ms = build_watch.elapsed_ms();
        if (!session) return;
        const Stopwatch solve_watch;
        const LaneGraph* const start = arguments.start;
        if (start != nullptr && is_feasible(problem, *start)) take(problem, *start, report);
        solve_and_separate(problem, *session, arguments.limits, deadline, report);
        report.solve_ms = solve_watch.elapsed_ms();
    }

    /// Nothing if a limit ended it before the program was loaded; the report then names the limit.
    std::unique_ptr<MilpSession> load(const LaneGraphProblem& problem, std::uint64_t seed,
                                      const Deadline& deadline, RldReport& report) {
        if (!model_) model_.emplace(form_.formulation);
        if (const auto stopped_by = model_->update(problem, deadline)) {
            report.status = SolveStatus::stopped;
            report.stopped_by = stopped_by;
            return nullptr;
        }
        if (!form_.all_rows) return solver_(model_->program(), seed);
        BinaryProgram whole = model_->program();
        add_connecting_flow(whole, problem);
        return solver_(whole, seed);
    }

    static void take(const LaneGraphProblem& problem, LaneGraph graph, RldReport& report) {
        report.objective = objective(problem, graph);
        report.lane_graph = std::move(graph);
    }

    /// A lane graph in the report is the start: the solver looks for a better one.
    void solve_and_separate(const LaneGraphProblem& problem, MilpSession& session, const SolveLimits& limits,
                            const Deadline& deadline, RldReport& report) const {
        const bool has_start = report.lane_graph.has_value();
        MilpLimits round_limits{deadline.remaining_ms(), limits.absolute_gap};
        if (has_start) round_limits.cutoff = *report.objective - limits.absolute_gap;
        while (true) {
            round_limits.time_limit_ms = deadline.remaining_ms();
            if (round_limits.time_limit_ms <= 0.0) {
                report.status = SolveStatus::stopped;
                report.stopped_by = StopReason::time;
                if (has_start) keep_start(round_limits.cutoff, report);
                return;
            }
            const MilpReport round = session.solve(round_limits);
            ++report.rounds;
            report.nodes += round.nodes;
            report.status = round.status;
            report.stopped_by = round.stopped_by;
            report.message = round.message;
            // Rows only tighten the program, so every round's bound holds for the problem.
            if (round.bound) report.bound = std::max(report.bound.value_or(*round.bound), *round.bound);
            if (round.status == SolveStatus::infeasible) report.bound.reset();
            if (round.point.empty()) {
                if (has_start) keep_start(round_limits.cutoff, report);
                return;
            }
            const std::vector<ProgramRow> violated = model_->separate(round.point);
            if (violated.empty()) {
                LaneGraph graph = model_->decode(round.point);
                if (!is_feasible(problem, graph)) {
                    report.status = SolveStatus::error;
                    report.stopped_by.reset();
                    report.bound.reset();
                    report.message = "the solver's point violates the program";
                    return;
                }
                // A backend that ignores the cutoff may stop at a point that costs more than the start.
                if (!has_start || objective(problem, graph) < *report.objective) {
                    take(problem, std::move(graph), report);
                }
                // The bound is a sum of the solver: it may exceed the objective by rounding only.
                if (report.bound) report.bound = std::min(*report.bound, *report.objective);
                return;
            }
            session.add_rows(violated);
        }
    }

    /// For a round that ended without a point: if no point is below the cutoff, the start is optimal.
    static void keep_start(double cutoff, RldReport& report) {
        if (report.status == SolveStatus::infeasible) {
            report.status = SolveStatus::optimal;
            report.bound = cutoff;
        } else if (report.status == SolveStatus::stopped) {
            report.status = SolveStatus::feasible;
            // With a cutoff, the solver has proved its bound only up to the cutoff.
            if (report.bound) report.bound = std::min(*report.bound, cutoff);
        }
    }

    MilpSolver solver_;
    ProgramForm form_;
    std::optional<LaneGraphModel> model_;  ///< built once, then updated
};

}  // namespace

std::unique_ptr<RldSolver> make_milp_rld_solver(MilpSolver solver, ProgramForm form) {
    return std::make_unique<MilpRldSolver>(std::move(solver), form);
}

}  // namespace conelane
