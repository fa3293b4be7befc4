// Solvers of the core in several threads at once, one instance each.

#include "conelane/lane_graph_problem.hpp"
#include "solvers/core_entries.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/testing.hpp"

#include <thread>

namespace conelane {
namespace {

constexpr std::size_t kThreads = 4;
constexpr std::size_t kScenes = 12;

std::vector<RldReport> solve_all(std::unique_ptr<RldSolver> solver, std::size_t cones) {
    std::vector<RldReport> reports;
    for (std::uint64_t seed = 0; seed < kScenes; ++seed) {
        reports.push_back(solver->solve(make_problem(tests::random_scene(seed, cones), {}), {}));
    }
    return reports;
}

template <typename Make>
void expect_the_same_in_threads(Make make, std::size_t cones) {
    const std::vector<RldReport> alone = solve_all(make(), cones);
    std::vector<std::vector<RldReport>> together(kThreads);
    {
        std::vector<std::jthread> threads;
        for (std::vector<RldReport>& reports : together) {
            threads.emplace_back([&reports, make, cones] { reports = solve_all(make(), cones); });
        }
    }
    for (const std::vector<RldReport>& reports : together) {
        ASSERT_EQ(reports.size(), alone.size());
        for (std::size_t scene = 0; scene < alone.size(); ++scene) {
            EXPECT_EQ(reports[scene].status, alone[scene].status);
            EXPECT_EQ(reports[scene].lane_graph, alone[scene].lane_graph);
            EXPECT_EQ(reports[scene].objective, alone[scene].objective);
            EXPECT_EQ(reports[scene].nodes, alone[scene].nodes);
        }
    }
}

TEST(SolverThreads, PathPair) {
    expect_the_same_in_threads([] { return make_path_pair_solver(); }, 24);
}

TEST(SolverThreads, Exhaustive) {
    expect_the_same_in_threads([] { return make_exhaustive_solver(); }, 7);
}

}  // namespace
}  // namespace conelane
