#include "solvers/solve_report.hpp"

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
            return "time_limit";
        case SolveStatus::error:
            break;
    }
    return "error";
}

}  // namespace conelane
