// An allocation that fails, at any place of a call: the call throws std::bad_alloc, loses nothing, and the
// next call answers as if nothing had happened.

#include "conelane/core_solvers.hpp"
#include "evaluation/formats/scene_set.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"
#include "tests/support/detector_names.hpp"
#include "tests/support/failing_allocations.hpp"
#include "tests/support/no_time_limit.hpp"
#include "tests/support/random_scenes.hpp"

namespace conelane {
namespace {

using tests::allocations;

/// A scene that has a lane, with few enough cones for exhaustive.
constexpr std::uint64_t kSeed = 0;

/// The first allocations, the last ones, and some between.
std::vector<std::int64_t> places(std::int64_t count) {
    constexpr std::int64_t kAtEachEnd = 20;
    constexpr int kBetween = 40;
    std::vector<std::int64_t> chosen;
    boost::random::mt19937_64 random(20);
    for (std::int64_t i = 0; i < std::min(count, kAtEachEnd); ++i) {
        chosen.push_back(i);
        chosen.push_back(count - 1 - i);
    }
    for (int i = 0; i < kBetween; ++i)
        chosen.push_back(boost::random::uniform_int_distribution<std::int64_t>(0, count - 1)(random));
    return chosen;
}

/// The number of allocations of a call.
std::int64_t count_allocations(const std::function<void()>& call) {
    allocations.made = 0;
    call();
    return allocations.made;
}

/// Runs the call with one failing allocation. Returns whether std::bad_alloc was thrown; a call that can do
/// without the memory (std::stable_sort) continues.
bool runs_out(const std::function<void()>& call, std::int64_t place) {
    allocations.until_failure = place;
    bool failed = false;
    try {
        call();
    } catch (const std::bad_alloc&) {
        failed = true;
    }
    allocations.until_failure = -1;
    return failed;
}

/// Runs a call that makes `count` allocations once for each of the places, with the one there failing, and
/// expects that no memory is lost. Returns how many of the calls threw.
int run_out_everywhere(std::int64_t count, const std::function<bool(std::int64_t place)>& call) {
    int failures = 0;
    for (const std::int64_t place : places(count)) {
        SCOPED_TRACE(testing::Message() << "allocation " << place << " of " << count);
        const std::int64_t living = allocations.living;
        failures += call(place) ? 1 : 0;
        EXPECT_EQ(allocations.living, living) << "memory is lost";
    }
    return failures;
}

/// A lane among false positives, the cones seen from two poses.
const std::vector<Scene>& lap() {
    static const std::vector<Scene> kLap = [] {
        SceneOptions options{
            .false_positive_rates = {0.3}, .ranges_m = {20.0}, .every_m = 60.0, .noise_sigma_m = 0.05};
        std::vector<Scene> scenes =
            mapped(make_scene_set({"generated:kidney"}, options).scenes, &AnnotatedScene::scene);
        scenes.resize(2);
        return scenes;
    }();
    return kLap;
}

class DetectorMemory : public testing::TestWithParam<std::string> {
  protected:
    /// Both scenes of the lap; the second one is answered by the warm detector.
    static std::vector<LaneAnswer> drive(LaneDetector& detector) {
        std::vector<LaneAnswer> answers;
        answers.reserve(lap().size());
        for (const Scene& scene : lap()) answers.push_back(detector.detect(scene, tests::kNoTimeLimit));
        return answers;
    }
    static void expect_same(const std::vector<LaneAnswer>& answers, const std::vector<LaneAnswer>& expected) {
        ASSERT_EQ(answers.size(), expected.size());
        for (std::size_t i = 0; i < answers.size(); ++i) {
            EXPECT_EQ(answers[i].status, expected[i].status) << answers[i].message;
            EXPECT_EQ(answers[i].lane, expected[i].lane);
            EXPECT_EQ(answers[i].confidence, expected[i].confidence);
        }
    }
};

TEST_P(DetectorMemory, MayRunOutAnywhereInACall) {
    const std::vector<LaneAnswer> expected = drive(*make_detector(GetParam()));  // loads the shared weights
    ASSERT_EQ(expected.back().status, LaneStatus::found);
    const std::int64_t count = [&] {
        const auto detector = make_detector(GetParam());
        return count_allocations([&] { (void)drive(*detector); });
    }();
    ASSERT_GT(count, 10);
    const int failures = run_out_everywhere(count, [&](std::int64_t place) {
        const auto detector = make_detector(GetParam());
        const bool failed = runs_out([&] { (void)drive(*detector); }, place);
        detector->reset();
        expect_same(drive(*detector), expected);
        return failed;
    });
    EXPECT_GT(failures, 20);
}

TEST_P(DetectorMemory, MayRunOutWhereADetectorIsMade) {
    (void)make_detector(GetParam());
    const std::int64_t count = count_allocations([] { (void)make_detector(GetParam()); });
    ASSERT_GT(count, 0);
    run_out_everywhere(count, [](std::int64_t place) {
        const bool failed = runs_out([] { (void)make_detector(GetParam()); }, place);
        EXPECT_TRUE(failed);
        return failed;
    });
}

INSTANTIATE_TEST_SUITE_P(Detectors, DetectorMemory, testing::ValuesIn(tests::detector_names()),
                         [](const auto& test) { return case_name(test.param); });

class SolverMemory : public testing::TestWithParam<const RldSolverEntry*> {};

TEST_P(SolverMemory, MayRunOutAnywhereInASolve) {
    const std::size_t cones = GetParam()->max_cones.value_or(40);
    const LaneGraphProblem problem = make_problem(tests::random_scene(kSeed, cones), {});
    const auto make = [] { return GetParam()->make(Formulation::tight); };
    const RldReport expected = make()->solve(problem, {});
    if (GetParam()->has(SolverTrait::exact)) {
        ASSERT_EQ(expected.status, SolveStatus::optimal);
    }
    const LaneGraph start = make_path_pair_solver()->solve(problem, {}).lane_graph.value();
    const std::int64_t count = [&] {
        const auto solver = make();
        return count_allocations([&] { (void)solver->solve(problem, {.start = &start}); });
    }();
    const int failures = run_out_everywhere(count, [&](std::int64_t place) {
        const auto solver = make();
        const bool failed = runs_out([&] { (void)solver->solve(problem, {.start = &start}); }, place);
        const RldReport report = solver->solve(problem, {});
        EXPECT_EQ(report.status, expected.status) << report.message;
        EXPECT_EQ(report.lane_graph, expected.lane_graph);
        EXPECT_EQ(report.objective, expected.objective);
        return failed;
    });
    EXPECT_GT(failures, 10);
}

TEST_P(SolverMemory, MayRunOutWhereAProblemIsMade) {
    const Scene scene = tests::random_scene(kSeed, 24);
    const auto make = [&] { (void)make_problem(scene, with_shape_costs({})); };
    const std::int64_t count = count_allocations(make);
    run_out_everywhere(count, [&](std::int64_t place) {
        const bool failed = runs_out(make, place);
        EXPECT_TRUE(failed);
        return failed;
    });
}

std::vector<const RldSolverEntry*> solvers() {
    return mapped(core_solvers(), [](const RldSolverEntry& entry) { return &entry; });
}

INSTANTIATE_TEST_SUITE_P(Core, SolverMemory, testing::ValuesIn(solvers()),
                         [](const auto& test) { return case_name(test.param->name); });

}  // namespace
}  // namespace conelane
