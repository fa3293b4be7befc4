// The cone set and the context of an RLD detector.

#include "conelane/rld_detector.hpp"

#include "conelane/solve_scene.hpp"
#include "solvers/registry.hpp"
#include "tests/support/no_time_limit.hpp"
#include "tests/support/testing.hpp"

namespace conelane {
namespace {

/// A straight lane along +x, cones every 3.2 m: left 1 to 8, right 101 to 108; the car is 1 m before it.
Scene straight() {
    Scene scene;
    scene.pose.position = {-1, 0};
    for (int i = 0; i < 8; ++i) {
        scene.cones.push_back({.id = 1 + i, .position = {3.2 * i, 1.6}});
        scene.cones.push_back({.id = 101 + i, .position = {3.2 * i, -1.6}});
    }
    return scene;
}

LaneAnswer detect(const Scene& scene, std::optional<std::size_t> nearest,
                  std::optional<std::size_t> context) {
    return make_rld_detector(find_rld_solver("path-pair")->make(Formulation::tight),
                             {.parameters = {}, .cones = {nearest, context}})
        ->detect(scene, tests::kNoTimeLimit);
}

/// A false cone left of the end of the sixth gap, nearer to the car than the true cones 4 and 104 at x = 9.6.
Scene with_false_cone() {
    Scene scene = straight();
    scene.cones.push_back({.id = 200, .position = {8.6, 2.9}});
    return scene;
}

TEST(RldDetector, WithoutContextTakesAFalseConeAtTheEndOfItsConeSet) {
    const LaneAnswer answer = detect(with_false_cone(), 7, std::nullopt);
    ASSERT_EQ(answer.status, LaneStatus::found);
    EXPECT_THAT(answer.lane.left, ElementsAre(1, 2, 3, 200));
    EXPECT_THAT(answer.lane.right, ElementsAre(101, 102, 103));
    EXPECT_TRUE(answer.optimality);
    EXPECT_FALSE(answer.solved);
}

TEST(RldDetector, WithContextFindsTheLaneThatGoesOnAndCutsIt) {
    const LaneAnswer answer = detect(with_false_cone(), 7, 17);
    ASSERT_EQ(answer.status, LaneStatus::found);
    EXPECT_THAT(answer.lane.left, ElementsAre(1, 2, 3));
    EXPECT_THAT(answer.lane.right, ElementsAre(101, 102, 103));
    EXPECT_FALSE(answer.optimality) << "what was proven is about the lane before the cut";
    ASSERT_TRUE(answer.solved);
    EXPECT_THAT(answer.solved->lane.left, ElementsAre(1, 2, 3, 4, 5, 6, 7, 8));
    ASSERT_TRUE(answer.solved->optimality);
    EXPECT_TRUE(answer.solved->optimality->optimal);
}

TEST(RldDetector, ALaneThatTheCutLeavesWholeStaysOptimal) {
    const LaneAnswer answer = detect(straight(), 16, 17);
    ASSERT_EQ(answer.status, LaneStatus::found);
    EXPECT_THAT(answer.lane.left, ElementsAre(1, 2, 3, 4, 5, 6, 7, 8));
    EXPECT_TRUE(answer.optimality);
    EXPECT_FALSE(answer.solved);
}

TEST(RldDetector, ContextNoLargerThanTheConeSetChangesNothing) {
    const Scene scene = with_false_cone();
    for (const std::size_t context : {3U, 7U}) {
        const LaneAnswer answer = detect(scene, 7, context);
        EXPECT_EQ(answer.lane, detect(scene, 7, std::nullopt).lane);
        EXPECT_FALSE(answer.solved);
    }
    EXPECT_EQ(detect(scene, std::nullopt, 5).lane, detect(scene, std::nullopt, std::nullopt).lane);
}

TEST(RldDetector, AnswersNoLaneWhereTheCutLeavesASideEmpty) {
    Scene scene = straight();
    std::erase_if(scene.cones, [](const Cone& cone) { return cone.id == 1; });
    const LaneAnswer answer = detect(scene, 1, 20);  // cone 101 alone
    EXPECT_EQ(answer.status, LaneStatus::none);
    EXPECT_EQ(answer.lane, Lane{});
}

/// The first two cones on the left were missed: no cone there is within d_near, so no lane graph is feasible.
TEST(RldDetector, TriesOtherValuesOfDNearWhereNoLaneGraphIsFeasible) {
    Scene late = straight();
    std::erase_if(late.cones, [](const Cone& cone) { return cone.id == 1 || cone.id == 2; });
    const auto by = [](const Scene& scene, std::vector<double> other_d_near_m) {
        return make_rld_detector(find_rld_solver("path-pair")->make(Formulation::tight),
                                 {.parameters = {}, .cones = {}, .other_d_near_m = std::move(other_d_near_m)})
            ->detect(scene, tests::kNoTimeLimit);
    };
    EXPECT_EQ(by(late, {}).status, LaneStatus::none);
    EXPECT_EQ(by(late, {4.0, 5.0}).status, LaneStatus::none);
    const LaneAnswer answer = by(late, {5.0, 8.0});
    ASSERT_EQ(answer.status, LaneStatus::found);
    EXPECT_THAT(answer.lane.left, ElementsAre(3, 4, 5, 6, 7, 8));
    EXPECT_THAT(answer.lane.right, ElementsAre(101, 102, 103, 104, 105, 106, 107, 108));
    EXPECT_FALSE(answer.optimality) << "it is optimal for another program";
    ASSERT_TRUE(answer.solved);
    EXPECT_EQ(answer.solved->lane, answer.lane);
    EXPECT_EQ(answer.solved->d_near_m, 8.0);
    EXPECT_THAT(answer.message, HasSubstr("another d_near"));

    // All cones of a short view are near, so there is no far end.
    Scene early = straight();
    std::erase_if(early.cones, [](const Cone& cone) { return cone.id % 100 > 2; });
    EXPECT_EQ(by(early, {}).status, LaneStatus::none);
    EXPECT_THAT(by(early, {4.0}).lane.left, ElementsAre(1, 2));

    const LaneAnswer whole = by(straight(), {8.0});
    EXPECT_TRUE(whole.optimality) << "the first program has a lane";
    EXPECT_EQ(whole.message, "");
}

/// A solver without a search: it answers what the test says, one report a call.
class Told : public RldSolver {
  public:
    explicit Told(std::vector<RldReport> reports) : reports_(std::move(reports)) {}

  private:
    void run(const LaneGraphProblem&, const SolveArguments&, RldReport& report) override {
        report = reports_.at(calls_++);
    }
    std::vector<RldReport> reports_;
    std::size_t calls_ = 0;
};

TEST(RldDetector, ATryThatIsNotFinishedIsNotTheAnswerNoLane) {
    RldReport infeasible;
    infeasible.status = SolveStatus::infeasible;
    RldReport stopped;
    stopped.status = SolveStatus::stopped;
    stopped.stopped_by = StopReason::time;
    RldReport failed;  // its status is error
    failed.message = "out of luck";
    const auto answer = [](std::vector<RldReport> reports) {
        return make_rld_detector(std::make_unique<Told>(std::move(reports)),
                                 {.parameters = {}, .cones = {}, .other_d_near_m = {5.0, 8.0}})
            ->detect(straight(), tests::kNoTimeLimit);
    };
    EXPECT_EQ(answer({infeasible, infeasible, infeasible}).status, LaneStatus::none);
    const LaneAnswer of_stopped = answer({infeasible, stopped});
    EXPECT_EQ(of_stopped.status, LaneStatus::stopped);
    EXPECT_EQ(of_stopped.stopped_by, StopReason::time);
    const LaneAnswer of_failed = answer({infeasible, failed});
    EXPECT_EQ(of_failed.status, LaneStatus::error);
    EXPECT_EQ(of_failed.message, "out of luck");
}

TEST(RldDetector, ScenesThatAreNotValidAreRefusedByItAndBySolveScene) {
    const auto solver = find_rld_solver("path-pair")->make(Formulation::tight);
    const auto refusals = [&](const Scene& scene) {
        const SolvedScene solved = solve_scene(*solver, scene, {}, {});
        EXPECT_EQ(solved.report.status, SolveStatus::error);
        const LaneAnswer answer = detect(scene, std::nullopt, std::nullopt);
        EXPECT_EQ(answer.status, LaneStatus::error);
        return std::array{solved.report.message, answer.message};
    };
    Scene scene = straight();
    scene.cones[3].id = scene.cones[1].id;
    EXPECT_THAT(refusals(scene), Each(HasSubstr("cones[3].id")));
    scene = straight();
    scene.cones[2].position.y() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(refusals(scene), Each(HasSubstr("cones[2].y")));
    // Valid, but the distance from the car is infinite.
    scene = straight();
    scene.pose.position.x() = 1.5e308;
    scene.cones[4].position.x() = -1.5e308;
    EXPECT_THAT(refusals(scene), Each(HasSubstr("cones[4].x")));
}

TEST(CutToNearest, EvensFarEndsAndOpensWhatItCuts) {
    // The five nearest are 1, 101, 2, 102 and of the two at x = 6.4 the left one, whose id is smaller.
    EXPECT_EQ(cut_to_nearest({{1, 2, 3, 4}, {101, 102, 103, 104}, true}, straight(), 5),
              (Lane{{1, 2, 3}, {101, 102}, false}));
    // Cone 3 at x = 6.4 is 7.2 m from cone 101 alone, so it goes; cone 2 is within 6.5 m.
    EXPECT_EQ(cut_to_nearest({{1, 2, 3}, {101}}, straight(), 16), (Lane{{1, 2}, {101}}));
    const Lane circuit{{1, 2, 3}, {101, 102, 103}, true};
    EXPECT_EQ(cut_to_nearest(circuit, straight(), 16), circuit);
}

}  // namespace
}  // namespace conelane
