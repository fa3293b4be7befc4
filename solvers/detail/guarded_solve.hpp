#pragma once

#include "model/lane_graph_problem.hpp"
#include "solvers/solve_report.hpp"

#include <algorithm>
#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <utility>

namespace conelane::detail {

/// What every RldSolver::solve has around it: limits that are no limits are refused, whatever `work(report)`
/// throws but std::bad_alloc becomes status error, and a feasible start that is cheaper than what was found
/// takes its place: a search without a lane graph is then feasible instead of stopped, an error stays one.
template <typename Work>
RldReport guarded_solve(const LaneGraphProblem& problem, const SolveLimits& limits, const LaneGraph* start,
                        Work&& work) {
    RldReport report;
    const auto fail = [&report](std::string message) {
        report = {};
        report.message = std::move(message);
    };
    try {
        if (const std::string_view wrong = invalidity(limits); !wrong.empty()) {
            report.message = wrong;
        } else {
            work(report);
        }
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        fail(error.what());
    } catch (...) {
        fail("the backend threw what is no std::exception");
    }
    if (start == nullptr || report.status == SolveStatus::optimal || !is_feasible(problem, *start)) {
        return report;
    }
    const double start_objective = objective(problem, *start);
    if (report.lane_graph && *report.objective <= start_objective) return report;
    report.lane_graph = *start;
    report.objective = start_objective;
    if (report.bound) report.bound = std::min(*report.bound, start_objective);
    if (report.status != SolveStatus::error) report.status = SolveStatus::feasible;
    return report;
}

}  // namespace conelane::detail
