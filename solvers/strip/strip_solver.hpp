#pragma once

#include "conelane/solve_report.hpp"
#include "model/strip_problem.hpp"

#include <functional>

namespace conelane {

/// What a search or a backend answers to a strip problem. `objective` is the cost of the lane's cheapest
/// strip; with status infeasible there is no strip.
struct StripReport : RldReport {
    std::vector<StripLane> lanes;  ///< the best first; with `lane_graph` the first one is its lane
};

struct StripOptions {
    SolveLimits limits = {};
    std::size_t lanes = 1;                     ///< number of different lanes wanted; at least 1
    std::size_t max_labels = 2'000'000;        ///< then it stops: iterations
    std::size_t labels_of_others = 2'000'000;  ///< at most so many more for the lanes after the best
    double worst_of_lanes = 1e300;             ///< lanes that cost so much more than the best are not wanted
};

/// The exact search. A state is the last edge of each boundary; its rung is the head. Costs to go are exact
/// where a strip may use a cone twice, so they bound every strip. A* over partial strips that use no cone
/// twice branches where the cheapest does, until the optimum is proven. An instance serves one thread.
class StripSolver {
  public:
    StripSolver();
    ~StripSolver();
    StripSolver(const StripSolver&) = delete;
    StripSolver& operator=(const StripSolver&) = delete;

    /// Every answer is verified. Throws only std::bad_alloc.
    [[nodiscard]] StripReport solve(const StripProblem& problem, const StripOptions& options);

  private:
    class Search;
    std::unique_ptr<Search> search_;
};

/// Runs a search of a strip problem and verifies what it says: the lane is recomputed from the problem, and
/// the bound is not above it. A wrong claim and any exception but std::bad_alloc become status error.
[[nodiscard]] StripReport verified_strip(const StripProblem& problem, const SolveLimits& limits,
                                         const std::function<void(StripReport&)>& run);

}  // namespace conelane
