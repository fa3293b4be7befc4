// path-pair keeps its workspace: the allocations of a solve do not grow with its nodes.

#include "solvers/path_pair/path_pair_solver.hpp"
#include "tests/support/counted_allocations.hpp"
#include "tests/support/random_scenes.hpp"

namespace conelane {
namespace {

struct Count {
    std::int64_t nodes;
    std::size_t allocations;
};

Count solve(RldSolver& solver, const LaneGraphProblem& problem) {
    const std::size_t before = allocations;
    const RldReport report = solver.solve(problem, {});
    return {report.nodes, allocations - before};
}

TEST(PathPairAllocation, DoesNotGrowWithTheNodes) {
    PathPairOptions options;
    // Switched off, to have many nodes.
    options.search_frontiers = false;
    options.root_steps = 1;
    options.node_steps = 1;
    const std::unique_ptr<RldSolver> solver = make_path_pair_solver(options);
    std::int64_t max_nodes = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const LaneGraphProblem problem = make_problem(tests::random_scene(seed, 20), {});
        solve(*solver, problem);  // the workspace grows to its size
        const Count again = solve(*solver, problem);
        max_nodes = std::max(max_nodes, again.nodes);
        EXPECT_LT(again.allocations, 40U) << again.nodes << " nodes";
    }
    EXPECT_GT(max_nodes, 400);
}

TEST(PathPairAllocation, DoesNotGrowWithTheLabelsOfTheTandemSearch) {
    const std::unique_ptr<RldSolver> solver = make_path_pair_solver();
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const LaneGraphProblem problem = make_problem(tests::random_scene(seed, 40), {});
        solve(*solver, problem);
        EXPECT_LT(solve(*solver, problem).allocations, 40U);
    }
}

}  // namespace
}  // namespace conelane
