#pragma once

#include "solvers/milp/milp_solver.hpp"

namespace conelane::detail {

/// The rows of a program at a point: their activities and limits, all of one length.
struct RowsAtPoint {
    std::span<const double> activity;
    std::span<const double> lower;
    std::span<const double> upper;
};

/// Well above CBC's own tolerance.
inline constexpr double kRowTolerance = 1e-4;

[[nodiscard]] inline bool violates_a_row(const RowsAtPoint& rows) {
    for (std::size_t r = 0; r < rows.activity.size(); ++r) {
        if (rows.activity[r] < rows.lower[r] - kRowTolerance) return true;
        if (rows.activity[r] > rows.upper[r] + kRowTolerance) return true;
    }
    return false;
}

enum class PointVerdict {
    kept,
    dropped,      ///< the time is over: the report says stopped, without a point
    search_anew,  ///< nothing in the report is valid; search again
};

/// CBC 2.10.8 sometimes returns points that violate rows. Drops such a point and everything reported with it.
/// Precondition: the report has a point, and the rows are evaluated at it.
[[nodiscard]] inline PointVerdict drop_invented_point(const RowsAtPoint& rows, bool is_time_up,
                                                      MilpReport& report) {
    if (!violates_a_row(rows)) return PointVerdict::kept;
    report = {};
    if (!is_time_up) return PointVerdict::search_anew;
    report.status = SolveStatus::stopped;
    report.stopped_by = StopReason::time;
    return PointVerdict::dropped;
}

}  // namespace conelane::detail
