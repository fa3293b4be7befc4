#include "evaluation/proofs/strip_check.hpp"

#include "solvers/strip/strip_solver.hpp"
#include "tests/support/strip_scenes.hpp"

namespace conelane::tests {
namespace {

Lane lane_of(const StripLane& lane, const Scene& scene) {
    Lane ids;
    for (const std::size_t cone : lane.left) ids.left.push_back(scene.cones[cone].id);
    for (const std::size_t cone : lane.right) ids.right.push_back(scene.cones[cone].id);
    return ids;
}

/// Costs of every kind, linear and of networks, and those of (29).
TEST(StripCheck, FindsTheCostOfEveryLane) {
    StripSolver solver;
    int lanes = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE(seed);
        const Scene scene = seed % 3 == 0 ? strewn_scene(14, 16.0, 12.0, seed) : random_scene(seed, 14);
        const StripParameters parameters = seed % 4 == 0
                                               ? strip_parameters_of(rld_without_width_and_heading())
                                               : random_strip_parameters(seed, seed % 2 == 0 ? 5 : 0);
        const StripProblem problem = make_strip_problem(scene, parameters);
        const StripReport report = solver.solve(problem, {.lanes = 4});
        for (const StripLane& lane : report.lanes) {
            const CheckReport check = check_strip(scene, parameters, lane_of(lane, scene));
            ASSERT_TRUE(check.objective) << check.violations.front();
            EXPECT_TRUE(check.violations.empty()) << check.violations.front();
            EXPECT_NEAR(*check.objective, cheapest_strip(problem, lane)->cost, 1e-8);
            ++lanes;
        }
    }
    EXPECT_GT(lanes, 100);
}

TEST(StripCheck, ObjectsToWrongLanesAndClaims) {
    const Scene scene = random_scene(5, 14);
    const StripParameters parameters = random_strip_parameters(5);
    const StripReport report = StripSolver().solve(make_strip_problem(scene, parameters), {});
    ASSERT_TRUE(report.objective);
    const Lane lane = lane_of(report.lanes.front(), scene);
    const auto objections = [&](const Lane& other, const Claim& claim) {
        return check_strip(scene, parameters, other, claim).violations.size();
    };
    const Claim right{true, *report.objective, report.bound};
    EXPECT_EQ(objections(lane, right), 0U);
    EXPECT_GT(objections(lane, {true, *report.objective + 0.1, report.bound}), 0U);
    EXPECT_GT(objections(lane, {true, *report.objective, *report.bound - 0.1}), 0U);
    EXPECT_GT(objections(lane, {false, *report.objective, *report.objective + 0.1}), 0U);
    Lane swapped = lane;
    std::swap(swapped.left, swapped.right);
    EXPECT_GT(objections(swapped, right), 0U);
    Lane backwards = lane;
    std::ranges::reverse(backwards.left);
    std::ranges::reverse(backwards.right);
    EXPECT_GT(objections(backwards, right), 0U);
    Lane twice = lane;
    twice.left.push_back(lane.right.back());
    EXPECT_GT(objections(twice, right), 0U);
    Lane unknown = lane;
    unknown.left.push_back(-5);
    EXPECT_GT(objections(unknown, right), 0U);
    EXPECT_GT(objections({}, right), 0U);
}

/// A long rung has to join a cone with one of its nearest; the problem and the check count them each by
/// itself.
TEST(StripCheck, LongRungsJoinCloseCones) {
    StripSolver solver;
    int objections = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        SCOPED_TRACE(seed);
        const Scene scene = strewn_scene(16, 16.0, 12.0, seed);
        StripParameters parameters = random_strip_parameters(seed);
        const StripProblem all = make_strip_problem(scene, parameters);
        parameters.w_usual_m = 4.0;
        parameters.nearest_of_rung = 3.0;
        const StripProblem some = make_strip_problem(scene, parameters);
        const auto distance_m = [&](std::size_t a, std::size_t b) {
            return (scene.cones[a].position - scene.cones[b].position).norm();
        };
        const auto is_close = [&](std::size_t end, std::size_t across) {
            int nearer = 0;
            for (std::size_t cone = 0; cone < scene.cones.size(); ++cone)
                nearer += cone != end && distance_m(end, cone) < distance_m(end, across) ? 1 : 0;
            return nearer < 3;
        };
        std::vector<std::pair<std::size_t, std::size_t>> expected;
        for (const StripRung& rung : all.rungs) {
            if (distance_m(rung.left, rung.right) <= 4.0 || is_close(rung.left, rung.right) ||
                is_close(rung.right, rung.left))
                expected.emplace_back(rung.left, rung.right);
        }
        ASSERT_LT(expected.size(), all.rungs.size());
        ASSERT_EQ(some.rungs.size(), expected.size());
        for (std::size_t k = 0; k < expected.size(); ++k)
            EXPECT_EQ(std::pair(some.rungs[k].left, some.rungs[k].right), expected[k]);
        const StripReport report = solver.solve(all, {});
        if (report.lanes.empty()) continue;
        const bool is_strip = cheapest_strip(some, report.lanes.front()).has_value();
        EXPECT_EQ(check_strip(scene, parameters, lane_of(report.lanes.front(), scene)).violations.empty(),
                  is_strip);
        objections += is_strip ? 0 : 1;
    }
    EXPECT_GT(objections, 3);
}

}  // namespace
}  // namespace conelane::tests
