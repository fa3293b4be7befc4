#pragma once

#include "conelane/lane_detector.hpp"
#include "conelane/solve_report.hpp"

namespace conelane {

/// What the status of a solver is for a detector: a lane, optimal or not, is found.
[[nodiscard]] inline LaneStatus lane_status(SolveStatus status) {
    if (status == SolveStatus::infeasible) return LaneStatus::none;
    if (status == SolveStatus::stopped) return LaneStatus::stopped;
    return status == SolveStatus::error ? LaneStatus::error : LaneStatus::found;
}

}  // namespace conelane
