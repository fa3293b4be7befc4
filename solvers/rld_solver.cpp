#include "conelane/rld_solver.hpp"

#include "model/answer_verification.hpp"

#include <exception>
#include <new>

namespace conelane {
namespace {

/// Backends know objectives and bounds to about 1e-7 (see SolveLimits).
constexpr double kTolerance = 1e-6;

double tolerance(double value) {
    return kTolerance * std::max(1.0, std::abs(value));
}

/// What is wrong with a report, in words; empty if nothing is. `known`: the objective of a feasible start.
std::string fault(const LaneGraphProblem& problem, const SolveLimits& limits, const RldReport& report,
                  const std::optional<double>& known) {
    const bool claims_lane_graph =
        report.status == SolveStatus::optimal || report.status == SolveStatus::feasible;
    if (claims_lane_graph != report.lane_graph.has_value()) {
        return claims_lane_graph ? "there is no lane graph" : "there is a lane graph without such a status";
    }
    if (report.status == SolveStatus::infeasible && known) {
        return "the problem is claimed to have no lane graph, but the start is one";
    }
    if (report.bound && std::isnan(*report.bound)) return "the bound is not a number";
    std::optional<double> cheapest = known;
    if (report.lane_graph) {
        const VerifiedAnswer answer = verify_answer(problem, *report.lane_graph);
        if (!answer.violation.empty()) return answer.violation;
        // This form of the comparison also fails for an objective that is not a number.
        if (!report.objective ||
            !(std::abs(*report.objective - answer.objective) <= tolerance(answer.objective))) {
            return "the objective is not the lane graph's, " + std::to_string(answer.objective);
        }
        if (report.status == SolveStatus::optimal && known &&
            answer.objective > *known + limits.absolute_gap + tolerance(*known)) {
            return "the start is cheaper than the optimum";
        }
        cheapest = std::min(answer.objective, known.value_or(answer.objective));
    }
    if (report.bound && cheapest && *report.bound > *cheapest + tolerance(*cheapest)) {
        return "the bound " + std::to_string(*report.bound) + " is above a lane graph of " +
               std::to_string(*cheapest);
    }
    return {};
}

}  // namespace

RldReport RldSolver::solve(const LaneGraphProblem& problem, const SolveArguments& arguments) {
    const SolveLimits& limits = arguments.limits;
    const LaneGraph* const start = arguments.start;
    RldReport report;
    const auto fail = [&report](std::string message) {
        report = {};
        report.message = std::move(message);
    };
    std::optional<double> known;
    if (start != nullptr) {
        const VerifiedAnswer answer = verify_answer(problem, *start);
        if (answer.violation.empty()) known = answer.objective;
    }
    try {
        if (const std::string_view wrong = invalidity(limits); !wrong.empty()) {
            report.message = wrong;
        } else {
            run(problem, arguments, report);
        }
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        fail(error.what());
    } catch (...) {
        fail("the backend threw something other than std::exception");
    }
    if (report.status != SolveStatus::error) {
        if (const std::string wrong = fault(problem, limits, report, known); !wrong.empty()) {
            fail("the answer fails its check: " + wrong);
        }
    } else {
        // After an error, nothing that the search claims counts.
        report.lane_graph.reset();
        report.objective.reset();
        report.bound.reset();
    }
    if (!known || report.status == SolveStatus::optimal) return report;
    if (report.lane_graph && *report.objective <= *known) return report;
    report.lane_graph = *start;
    report.objective = *known;
    if (report.bound) report.bound = std::min(*report.bound, *known);
    if (report.status != SolveStatus::error) report.status = SolveStatus::feasible;
    return report;
}

std::string_view to_string(SolveStatus status) {
    switch (status) {
        case SolveStatus::optimal:
            return "optimal";
        case SolveStatus::feasible:
            return "feasible";
        case SolveStatus::infeasible:
            return "infeasible";
        case SolveStatus::stopped:
            return "stopped";
        case SolveStatus::error:
            break;
    }
    return "error";
}

std::string_view invalidity(const SolveLimits& limits) {
    if (std::isnan(limits.time_limit_ms)) return "the time limit is not a number";
    if (std::isnan(limits.absolute_gap)) return "the absolute gap is not a number";
    if (limits.absolute_gap < 0.0) return "the absolute gap is negative";
    return {};
}

}  // namespace conelane
