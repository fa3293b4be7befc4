#pragma once

#include "conelane/lane_graph.hpp"
#include "conelane/stop_reason.hpp"

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace conelane {

enum class SolveStatus {
    optimal,     ///< the objective is within the absolute gap of the bound
    feasible,    ///< an incumbent that is not proven optimal; `stopped_by` names the limit that ended the
                 ///< search, or is absent from a heuristic
    infeasible,  ///< the problem is proven to have no solution
    stopped,     ///< neither incumbent nor proof; `stopped_by` as above
    error,       ///< see the message; a feasible start is kept
};
[[nodiscard]] std::string_view to_string(SolveStatus status);

/// Limits of a solver, which runs on one thread and has no relative gap. Every backend keeps the deadline
/// itself, so its incumbent is not lost. A MILP solver knows objectives only to the tolerance of its LP,
/// about 1e-7, however small the gap.
struct SolveLimits {
    /// Wall clock, from the call; infinity for no limit. At 0 and below nothing is tried.
    double time_limit_ms = std::numeric_limits<double>::infinity();
    double absolute_gap = 1e-9;  ///< an incumbent this close to the bound counts as optimal; >= 0
};
/// What is wrong with the limits, in words; empty if they are valid. NaN is invalid.
[[nodiscard]] std::string_view invalidity(const SolveLimits& limits);

/// What a solve gets besides the problem.
struct SolveArguments {
    SolveLimits limits = {};
    /// A lane graph that solvers may use as their first incumbent, or nullptr. An infeasible start is
    /// dropped. A feasible start stays the answer unless a cheaper lane graph or an optimum is found.
    const LaneGraph* start = nullptr;
    /// Not 0: draws the order of columns and rows for solvers from outside. The library's solvers ignore it.
    std::uint64_t seed = 0;
};

/// What an RLD solver answers.
struct RldReport {
    SolveStatus status = SolveStatus::error;
    std::optional<StopReason> stopped_by;
    std::optional<LaneGraph> lane_graph;  ///< if optimal or feasible; a feasible start also if error
    std::optional<double> objective;      ///< recomputed from the lane graph
    std::optional<double> bound;          ///< proven lower bound
    std::int64_t nodes = 0;               ///< of the search; each solver counts its own
    int rounds = 0;         ///< solves of the program: of a MILP solver, rounds of separated rows plus one
    double build_ms = 0.0;  ///< making the program from the problem
    double solve_ms = 0.0;
    std::string message;
};

}  // namespace conelane
