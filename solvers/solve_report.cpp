#include "conelane/solve_report.hpp"

#include <cmath>

namespace conelane {

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
