#include "solvers/milp/strip_milp.hpp"

#include "model/strip_model.hpp"

namespace conelane {
namespace {

void solve_and_separate(const StripModel& model, MilpSession& session, const StripProblem& problem,
                        const SolveLimits& limits, const Deadline& deadline, StripReport& report) {
    while (true) {
        const double remaining_ms = deadline.remaining_ms();
        if (remaining_ms <= 0.0) {
            report.status = SolveStatus::stopped;
            report.stopped_by = StopReason::time;
            return;
        }
        const MilpReport round = session.solve({remaining_ms, limits.absolute_gap});
        ++report.rounds;
        report.nodes += round.nodes;
        report.status = round.status;
        report.stopped_by = round.stopped_by;
        report.message = round.message;
        // Rows only tighten the program, so each round's bound holds.
        if (round.bound) report.bound = std::max(report.bound.value_or(*round.bound), *round.bound);
        if (round.status == SolveStatus::infeasible) report.bound.reset();
        if (round.point.empty()) return;
        const std::vector<ProgramRow> circulations = model.separate(round.point);
        if (!circulations.empty()) {
            session.add_rows(circulations);
            continue;
        }
        StripLane lane = model.decode(round.point);
        const auto strip = cheapest_strip(problem, lane);
        report.lane_graph = lane_graph_of(lane);
        report.lanes.push_back(std::move(lane));
        if (!strip) return;  // the verification says so
        report.objective = strip->cost;
        if (report.bound) report.bound = std::min(*report.bound, strip->cost);
        return;
    }
}

}  // namespace

StripReport solve_strip_by_milp(const MilpBackend& backend, const StripProblem& problem,
                                const SolveLimits& limits) {
    return verified_strip(problem, limits, [&](StripReport& report) {
        const Deadline deadline(limits.time_limit_ms);
        if (std::ranges::none_of(problem.rungs, &StripRung::may_start)) {
            report.status = SolveStatus::infeasible;
            return;
        }
        const Stopwatch watch;
        StripModel model(problem);
        if (const auto stopped_by = model.build(deadline)) {
            report.status = SolveStatus::stopped;
            report.stopped_by = stopped_by;
            return;
        }
        const std::unique_ptr<MilpSession> session = backend.load(model.program());
        report.build_ms = watch.elapsed_ms();
        solve_and_separate(model, *session, problem, limits, deadline, report);
        report.solve_ms = watch.elapsed_ms() - report.build_ms;
    });
}

}  // namespace conelane
