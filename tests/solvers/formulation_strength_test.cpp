// What the relaxation of each formulation proves without branching.

#include "model/lane_graph_model.hpp"
#include "solvers/registry.hpp"
#include "solvers/relaxation/relaxation_solver.hpp"
#include "tests/support/random_scenes.hpp"

namespace conelane {
namespace {

double relaxed(const Scene& scene, const RldParameters& parameters, Formulation formulation) {
    const LaneGraphProblem problem = make_problem(scene, parameters, parts(formulation).extent);
    return linear_relaxation(LaneGraphModel(problem, formulation).program()).value().optimum;
}

std::optional<double> optimum(const Scene& scene, const RldParameters& parameters) {
    return find_rld_solver("exhaustive")
        ->make(Formulation::tight)
        ->solve(make_problem(scene, parameters), {})
        .objective;
}

/// Five cones to the left of the car, three to the right, 3.2 m apart, costs nothing but the benefit of 1 an
/// edge. A lane may end no more than 3.2 m ahead of its other side: three edges left, two right. A relaxation
/// would rather take all six: each path ends half at its last cone and half at the one before, which would
/// face each other as partners. That the last edges of the two paths have no cone in common forbids it.
TEST(TightRelaxation, NoPathEndsHalfHereAndHalfThere) {
    Scene scene;
    scene.pose = {{0.0, 0.0}, 0.0};
    for (const int cone : {0, 1, 2, 3, 4}) scene.cones.push_back({cone, {4.0 + 3.2 * cone, 1.5}});
    for (const int cone : {0, 1, 2}) scene.cones.push_back({10 + cone, {4.0 + 3.2 * cone, -1.5}});
    RldParameters parameters{.w_p = 0.0};
    parameters.d_max = 4.5;  // across and one spacing: 4.39 m
    EXPECT_NEAR(optimum(scene, parameters).value(), -5.0, 1e-9);
    EXPECT_NEAR(relaxed(scene, parameters, Formulation::tight), -5.0, 1e-7);
    // With the printed pairing, a path between the two far ends is allowed; for it they are partners.
    parameters.pairing = Pairing::paper;
    EXPECT_LT(relaxed(scene, parameters, Formulation::tight), -5.0 - 1e-3);
}

/// A relaxation is never above the optimum, and the tight one proves at least as much as the printed one.
TEST(Relaxations, AreOrdered) {
    int proven = 0;
    int feasible = 0;
    for (std::uint64_t seed = 0; seed < 150; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const Scene scene = tests::random_scene(seed, 6 + seed % 3);
        RldParameters parameters{.pairing = seed % 2 == 0 ? Pairing::near_far : Pairing::paper};
        const std::optional<double> best = optimum(scene, parameters);
        if (!best) continue;
        ++feasible;
        const double tight = relaxed(scene, parameters, Formulation::tight);
        EXPECT_LE(tight, *best + 1e-7);
        EXPECT_LE(relaxed(scene, parameters, Formulation::paper), tight + 1e-7);
        if (tight > *best - 1e-7) ++proven;
    }
    EXPECT_GT(feasible, 20);
    EXPECT_GT(2 * proven, feasible) << "the tight relaxation is exact more often than not";
}

}  // namespace
}  // namespace conelane
