// Verdicts of the independent checker on the answers of RLD detectors.

#include "evaluation/proofs/answer_check.hpp"

#include "experiments/comparison/runner.hpp"
#include "tests/support/no_time_limit.hpp"
#include "tests/support/straight_scene.hpp"

namespace conelane::experiments {
namespace {

/// The answer of rld-pair on the straight lane, unchecked.
LaneRecord answer_on(const AnnotatedScene& scene) {
    LaneRecord record{scene.scene.id, "rld-pair", {}, 1.0, {}};
    record.answer = make_detector("rld-pair")->detect(scene.scene, tests::kNoTimeLimit);
    return record;
}

void expect_rejected(LaneRecord record, const AnnotatedScene& scene) {
    check_answer(record, scene.scene, {});
    EXPECT_FALSE(record.checked);
    EXPECT_EQ(record.answer.status, LaneStatus::error);
    EXPECT_THAT(record.answer.message, StartsWith("rejected by the checker: "));
    EXPECT_EQ(record.answer.lane, Lane{});
    EXPECT_FALSE(record.answer.optimality);
}

TEST(LaneGraphOf, JoinsNeighboursOfEachBoundary) {
    const AnnotatedScene scene = straight_scene();  // cones: 1, 101, 2, 102, 3, 103, ...
    const auto open = lane_graph_of({{1, 2, 3}, {101, 103}}, scene.scene);
    ASSERT_TRUE(open);
    EXPECT_THAT(open->edges, ElementsAre(Edge{0, 2}, Edge{1, 5}, Edge{2, 4}));
    const auto closed = lane_graph_of({{1, 2, 3}, {}, true}, scene.scene);
    ASSERT_TRUE(closed);
    EXPECT_THAT(closed->edges, ElementsAre(Edge{0, 2}, Edge{0, 4}, Edge{2, 4}));
    EXPECT_FALSE(lane_graph_of({{1, 77}, {101, 102}}, scene.scene));
    EXPECT_FALSE(lane_graph_of({{1, 1}, {101, 102}}, scene.scene));
}

TEST(CheckAnswer, MarksWhatItAccepts) {
    const AnnotatedScene scene = straight_scene();
    LaneRecord record = answer_on(scene);
    const Lane lane = record.answer.lane;
    check_answer(record, scene.scene, {});
    EXPECT_TRUE(record.checked);
    EXPECT_EQ(record.answer.status, LaneStatus::found);
    EXPECT_EQ(record.answer.lane, lane);
}

TEST(CheckAnswer, TurnsFalseClaimsIntoErrors) {
    const AnnotatedScene scene = straight_scene();
    const LaneRecord right = answer_on(scene);
    ASSERT_TRUE(right.answer.optimality);

    LaneRecord cheaper = right;
    cheaper.answer.optimality->objective -= 1.0;
    cheaper.answer.optimality->bound -= 1.0;
    expect_rejected(cheaper, scene);

    LaneRecord unproven = right;  // called optimal, but the bound is far below
    unproven.answer.optimality->bound -= 1.0;
    expect_rejected(unproven, scene);

    LaneRecord leaping = right;  // a cone is left out: a segment of 8 m
    leaping.answer.lane.left.erase(leaping.answer.lane.left.begin() + 2);
    leaping.answer.optimality.reset();
    expect_rejected(leaping, scene);

    LaneRecord unseen = right;
    unseen.answer.lane.left.back() = 77;
    expect_rejected(unseen, scene);
}

TEST(CheckAnswer, ChecksALaneByTheDNearThatItNames) {
    const AnnotatedScene scene = straight_scene();
    LaneRecord record = answer_on(scene);
    SolvedLane& solved = record.answer.solved.emplace(
        SolvedLane{.lane = record.answer.lane, .d_near_m = RldParameters{}.d_near});
    expect_rejected(record, scene);  // optimal for another program
    record.answer.optimality.reset();
    LaneRecord same = record;
    check_answer(same, scene.scene, {.d_near = 0.5});
    EXPECT_TRUE(same.checked) << same.answer.message;
    solved.d_near_m = 0.5;  // no cone is so near
    expect_rejected(record, scene);
}

TEST(CheckAnswer, ChecksTheUncutLaneOfALaneWithContext) {
    const AnnotatedScene scene = straight_scene();
    const DetectorRecipe& detector = *find_method("rld-context").recipe;
    LaneRecord right{scene.scene.id, "rld-context",
                     make_detector(detector)->detect(scene.scene, tests::kNoTimeLimit), 1.0,
                     cone_set(detector, {}).nearest};
    ASSERT_TRUE(right.answer.solved);
    LaneRecord record = right;
    check_answer(record, cone_set(detector, {}).seen(scene.scene), {});
    EXPECT_TRUE(record.checked) << record.answer.message;

    LaneRecord longer = right;  // not the result of the cut
    longer.answer.lane = longer.answer.solved->lane;
    expect_rejected(longer, scene);

    LaneRecord cheaper = right;
    cheaper.answer.solved->optimality->objective -= 1.0;
    cheaper.answer.solved->optimality->bound -= 1.0;
    expect_rejected(cheaper, scene);

    LaneRecord leaping = right;  // a cone is left out beyond the cut, so the cut gives the same lane
    leaping.answer.solved->lane.left.erase(leaping.answer.solved->lane.left.begin() + 8);
    leaping.answer.solved->optimality.reset();
    expect_rejected(leaping, scene);
}

TEST(CheckAnswer, LeavesRecordsWithoutALane) {
    const AnnotatedScene scene = straight_scene();
    LaneRecord none{"a", "rld-pair", {}, 1.0, {}};
    none.answer.status = LaneStatus::none;
    check_answer(none, scene.scene, {});
    EXPECT_EQ(none.answer.status, LaneStatus::none);
    EXPECT_FALSE(none.checked);
}

TEST(Run, ChecksRldAnswersOnTheirOwnConeSet) {
    SceneOptions options{.false_positive_rates = {0.3}, .ranges_m = {30.0}, .every_m = 15.0};
    const SceneSet set = make_scene_set({"generated:kidney"}, options);
    for (const char* detector : {"rld-cbc", "rld-pair", "rld-context", "rld-shape", "clc"}) {
        SCOPED_TRACE(detector);
        const Method method = find_method(detector);
        std::size_t found = 0;
        for (const LaneRecord& record : run(method, set.scenes, {})) {
            EXPECT_NE(record.answer.status, LaneStatus::error) << record.answer.message;
            EXPECT_EQ(record.checked, method.is_rld() && record.answer.status == LaneStatus::found);
            if (record.answer.status == LaneStatus::found) ++found;
        }
        EXPECT_GT(found, set.scenes.size() / 2);
    }
}

}  // namespace
}  // namespace conelane::experiments
