// path-pair keeps its workspace: the allocations of a solve do not grow with its nodes.

#include "conelane/lane_graph_problem.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/testing.hpp"

#include <new>

namespace {

std::int64_t allocations = 0;

}  // namespace

// Counts the allocations of the program. The other forms of new and delete call these.
[[gnu::noinline]] void* operator new(std::size_t size) {
    ++allocations;
    if (void* const memory = std::malloc(size == 0 ? 1 : size)) return memory;
    throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
    std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}

namespace conelane {
namespace {

struct Count {
    std::int64_t nodes;
    std::int64_t allocations;
};

Count solve(RldSolver& solver, const LaneGraphProblem& problem) {
    const std::int64_t before = allocations;
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
        EXPECT_LT(again.allocations, 40) << again.nodes << " nodes";
    }
    EXPECT_GT(max_nodes, 400);
}

TEST(PathPairAllocation, DoesNotGrowWithTheLabelsOfTheTandemSearch) {
    const std::unique_ptr<RldSolver> solver = make_path_pair_solver();
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const LaneGraphProblem problem = make_problem(tests::random_scene(seed, 40), {});
        solve(*solver, problem);
        EXPECT_LT(solve(*solver, problem).allocations, 40);
    }
}

}  // namespace
}  // namespace conelane
