#include "detectors/strip_detector.hpp"

#include "conelane/detectors.hpp"
#include "detectors/parameters/learned_costs_reader.hpp"
#include "detectors/recipe.hpp"
#include "solvers/milp/strip_milp.hpp"
#include "solvers/registry.hpp"
#include "tests/support/no_time_limit.hpp"
#include "tests/support/strip_scenes.hpp"

namespace conelane {
namespace {

StripParameters shipped() {
    StripParameters parameters = driving_strip_parameters();
    parameters.costs = parse_strip_costs(kStripWeightsFile);
    return parameters;
}

/// Another engine proves the same optimum of the shipped costs.
TEST(StripDetector, AnswersTheOptimumOfTheProgram) {
    const auto detector = make_detector("rld-strip");
    int lanes = 0;
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        SCOPED_TRACE(seed);
        const Scene scene = tests::random_scene(seed, 8 + seed % 6);
        const LaneAnswer answer = detector->detect(scene, tests::kNoTimeLimit);
        const StripReport by_program =
            solve_strip_by_milp(milp_backends().front(), make_strip_problem(scene, shipped()), {});
        if (answer.status != LaneStatus::found) continue;
        ++lanes;
        ASSERT_TRUE(answer.optimality && by_program.objective);
        EXPECT_TRUE(answer.optimality->optimal);
        EXPECT_NEAR(answer.optimality->objective, *by_program.objective, 1e-6);
        EXPECT_LE(answer.optimality->bound, answer.optimality->objective);
        ASSERT_TRUE(answer.confidence && answer.trusted_m);
        EXPECT_TRUE(*answer.confidence > 0.0 && *answer.confidence <= 1.0);
    }
    EXPECT_GT(lanes, 15);
}

/// Lanes that differ at once share their probability, and nothing of the answer is trusted. Alone it is
/// certain, over its whole length.
TEST(StripDetector, TrustsWhatLikelyLanesHaveInCommon) {
    int compared = 0;
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        SCOPED_TRACE(seed);
        const Scene scene = tests::random_scene(seed, 12);
        const StripProblem problem = make_strip_problem(scene, shipped());
        const StripReport report = StripSolver().solve(problem, {.lanes = 6});
        if (report.lanes.size() < 2) continue;
        ++compared;
        const std::span<const StripLane> lanes(report.lanes);
        const StripTrust alone = strip_trust(problem, scene, lanes.first(1));
        EXPECT_EQ(alone.confidence, 1.0);
        const StripTrust among = strip_trust(problem, scene, lanes);
        EXPECT_LE(among.confidence, 1.0);
        EXPECT_LE(among.trusted_m, alone.trusted_m);
        const std::array twice{lanes[0], lanes[0]};
        EXPECT_EQ(strip_trust(problem, scene, twice).trusted_m, alone.trusted_m);
        const double over =
            (cheapest_strip(problem, lanes[1])->cost - cheapest_strip(problem, lanes[0])->cost) /
            kStripTemperature;
        if (alone.trusted_m < 20.0) {
            EXPECT_NEAR(strip_trust(problem, scene, lanes.first(2)).confidence, 1.0 / (1.0 + std::exp(-over)),
                        1e-9);
        }
    }
    EXPECT_GT(compared, 10);
}

}  // namespace
}  // namespace conelane
