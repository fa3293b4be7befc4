// Relaxations and their rounding: derivatives equal finite differences, lane graphs pass the checker, and
// they are never better than the optimum or their own bound.

#include "solvers/relaxation/relaxation_solver.hpp"

#include "conelane/check.hpp"
#include "conelane/relaxation_solvers.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"
#include "tests/support/cones_at.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/six_cone_lane.hpp"

namespace conelane {
namespace {

TEST(EdgeRelaxation, GradientAndHessianAreThoseOfTheObjective) {
    const EdgeRelaxation relaxation(make_problem(tests::random_scene(3, 10), {}));
    std::vector<double> x(relaxation.variables());
    for (std::size_t v = 0; v < x.size(); ++v) x[v] = 0.1 + 0.8 * static_cast<double>(v % 7) / 6.0;
    ASSERT_FALSE(relaxation.products().empty());
    std::vector<std::vector<double>> hessian(x.size(), std::vector<double>(x.size(), 0.0));
    for (const EdgeRelaxation::Product& p : relaxation.products()) {
        ASSERT_LT(p.first, p.second);
        hessian[static_cast<std::size_t>(p.first)][static_cast<std::size_t>(p.second)] += p.factor;
        hessian[static_cast<std::size_t>(p.second)][static_cast<std::size_t>(p.first)] += p.factor;
    }
    constexpr double kStep = 1e-4;
    std::vector<double> gradient(x.size());
    std::vector<double> above(x.size());
    std::vector<double> below(x.size());
    relaxation.gradient(x, gradient);
    for (std::size_t v = 0; v < x.size(); ++v) {
        std::vector<double> plus = x;
        std::vector<double> minus = x;
        plus[v] += kStep;
        minus[v] -= kStep;
        const double slope = (relaxation.objective(plus) - relaxation.objective(minus)) / (2.0 * kStep);
        EXPECT_NEAR(gradient[v], slope, 1e-6) << "variable " << v;
        relaxation.gradient(plus, above);
        relaxation.gradient(minus, below);
        for (std::size_t w = 0; w < x.size(); ++w)
            EXPECT_NEAR(hessian[v][w], (above[w] - below[w]) / (2.0 * kStep), 1e-6) << v << ", " << w;
    }
}

TEST(EdgeRelaxation, HoldsTheOptimumWithItsObjective) {
    int solved = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const LaneGraphProblem problem = make_problem(tests::random_scene(seed, 12), {});
        const RldReport best = make_path_pair_solver()->solve(problem, {});
        if (!best.lane_graph) continue;
        ++solved;
        std::vector<double> values(problem.edges.size(), 0.0);
        std::vector<double> degree(problem.cone_count, 0.0);
        for (std::size_t e = 0; e < values.size(); ++e) {
            for (const Edge& edge : best.lane_graph->edges) {
                if (edge.i == problem.edges[e].i && edge.j == problem.edges[e].j) values[e] = 1.0;
            }
            degree[problem.edges[e].i] += values[e];
            degree[problem.edges[e].j] += values[e];
        }
        const EdgeRelaxation relaxation(problem);
        std::vector<double> x = relaxation.point(values);
        for (std::size_t cone = 0; cone < degree.size(); ++cone)
            x[relaxation.edges().size() + cone] = degree[cone] > 0.0 ? 1.0 : 0.0;
        EXPECT_NEAR(relaxation.objective(x), *best.objective, 1e-9) << "seed " << seed;
        for (const EdgeRelaxation::Row& row : relaxation.rows()) {
            double sum = 0.0;
            for (const auto& [variable, factor] : row.terms)
                sum += factor * x[static_cast<std::size_t>(variable)];
            EXPECT_TRUE(row.lower <= sum && sum <= row.upper) << "seed " << seed;
        }
    }
    EXPECT_GT(solved, 5);
}

TEST(Relaxations, AnswerLaneGraphsBetweenBoundAndOptimumAndClaimNoOptimality) {
    ASSERT_FALSE(relaxation_solvers().empty());
    for (const RldSolverEntry& entry : relaxation_solvers()) {
        const std::unique_ptr<RldSolver> solver = entry.make(Formulation::tight);
        int found = 0;
        for (std::uint64_t seed = 0; seed < 30; ++seed) {
            SCOPED_TRACE(std::string(entry.name) + ", seed " + std::to_string(seed));
            const Scene scene = tests::random_scene(seed, 12);
            const LaneGraphProblem problem = make_problem(scene, {});
            const RldReport best = make_path_pair_solver()->solve(problem, {});
            const RldReport report = solver->solve(problem, {});
            EXPECT_NE(report.status, SolveStatus::optimal);
            const bool has_lane_graph = best.status == SolveStatus::optimal;
            EXPECT_TRUE(has_lane_graph || report.status != SolveStatus::feasible);
            EXPECT_TRUE(!has_lane_graph || report.status != SolveStatus::infeasible);
            if (report.status != SolveStatus::feasible) continue;
            ++found;
            EXPECT_TRUE(check(scene, {}, *report.lane_graph).violations.empty());
            EXPECT_GE(*report.objective, *best.objective - 1e-9);
            EXPECT_LE(*report.bound, *best.objective + 1e-6);
        }
        EXPECT_GT(found, 5) << entry.name;
    }
}

/// Two straight boundaries at the expected spacing and nothing else: four edges at -1 each, which is also the
/// optimum of the linear relaxation.
TEST(Relaxations, FindTheOnlyLane) {
    const Scene scene = tests::six_cone_lane();
    const LaneGraph lane{{{0, 1}, {1, 2}, {3, 4}, {4, 5}}};
    for (const RldSolverEntry& entry : relaxation_solvers()) {
        const RldReport report = entry.make(Formulation::tight)->solve(make_problem(scene, {}), {});
        ASSERT_EQ(report.status, SolveStatus::feasible) << entry.name << ": " << report.message;
        EXPECT_EQ(report.lane_graph, lane) << entry.name;
        EXPECT_NEAR(*report.objective, -4.0, 1e-9) << entry.name;
        EXPECT_NEAR(*report.bound, -4.0, 1e-6) << entry.name;
    }
}

/// The linear relaxation proves it; other heuristics do not have to.
TEST(Relaxations, ProveThatTooFewConesHaveNoLane) {
    const Scene too_few = tests::cones_at({{4, 1.5}, {7.2, 1.5}, {4, -1.5}});
    const Scene one_place = tests::cones_at(std::vector<Point>(8, {5, 1}));
    for (const RldSolverEntry& entry : relaxation_solvers()) {
        const std::unique_ptr<RldSolver> solver = entry.make(Formulation::tight);
        for (const Scene& scene : {Scene{}, too_few, one_place}) {
            const RldReport report = solver->solve(make_problem(scene, {}), {});
            EXPECT_EQ(report.status, SolveStatus::infeasible)
                << entry.name << ", " << scene.cones.size() << " cones: " << report.message;
        }
    }
}

}  // namespace
}  // namespace conelane
