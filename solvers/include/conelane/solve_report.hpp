#pragma once

#include "conelane/lane_graph.hpp"
#include "conelane/stop_reason.hpp"

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace conelane {

enum class SolveStatus {
    optimal,     ///< the objective is within the absolute gap of the bound
    feasible,    ///< an incumbent that is not proven optimal; cut off by a limit where `stopped_by` is there,
                 ///< else the best that a heuristic can do
    infeasible,  ///< proven to have no solution
    stopped,     ///< no incumbent, no proof; at a limit where `stopped_by` is there, else by a heuristic
    error,       ///< see the message; a start that is feasible is kept
};
[[nodiscard]] std::string_view to_string(SolveStatus status);

/// The same for every solver, and each runs on one thread, without a relative gap. Wall clock: every backend
/// keeps a deadline of its own and the incumbent with it. A MILP solver knows objectives to the tolerance of
/// its LP, about 1e-7, whatever gap is asked for: CBC looks for points that are better by 1e-7 at least, GLPK
/// by 1e-9 of the objective; clp-bb takes the gap as it is.
struct SolveLimits {
    /// Wall clock, from the call; infinity for none. At 0 and below nothing is tried.
    double time_limit_ms = std::numeric_limits<double>::infinity();
    double absolute_gap = 1e-9;  ///< an incumbent this close to the bound is optimal; not negative
};
/// What is wrong with the limits, in words; empty where they are valid. A limit that is NaN is not.
[[nodiscard]] std::string_view invalidity(const SolveLimits& limits);

/// What a MILP solver answers. Absent values are unknown.
struct MilpReport {
    SolveStatus status = SolveStatus::error;
    std::optional<StopReason> stopped_by;
    std::vector<double> point;    ///< the incumbent by column; empty without one
    std::optional<double> bound;  ///< proven lower bound of the objective
    std::int64_t nodes = 0;       ///< branch-and-bound nodes; 0 where the first relaxation was integral
    std::string message;
};

/// What an RLD solver answers.
struct RldReport {
    SolveStatus status = SolveStatus::error;
    std::optional<StopReason> stopped_by;
    std::optional<LaneGraph> lane_graph;  ///< with status optimal and feasible; with error the warm start
    std::optional<double> objective;      ///< recomputed from the lane graph
    std::optional<double> bound;          ///< proven lower bound
    std::int64_t nodes = 0;
    int rounds = 0;         ///< times the program was solved; one more than rounds of separated rows
    double build_ms = 0.0;  ///< making the program from the problem
    double solve_ms = 0.0;
    std::string message;
};

}  // namespace conelane
