// Graph search and exact search under one objective.

#include "experiments/studies/optimality.hpp"

#include "conelane/invalid_input.hpp"
#include "conelane/rld_parameter_sets.hpp"
#include "evaluation/formats/scene_set.hpp"
#include "tests/support/straight_scene.hpp"
#include "tests/support/testing.hpp"

namespace conelane::experiments {
namespace {

using testing::HasSubstr;

SceneSet some_scenes(std::vector<double> rates) {
    SceneOptions options;
    options.false_positive_rates = std::move(rates);
    options.ranges_m = {25.0};
    options.every_m = 20.0;
    return make_scene_set({"generated:kidney", "generated:straight"}, options);
}

JudgedLane lane_of(double objective) {
    JudgedLane lane;
    lane.objective = objective;
    return lane;
}

TEST(OptimalityRow, GapIsRelativeToTheOptimumButNotToLessThanOne) {
    OptimalityRow row;
    row.optimum = lane_of(-8.0);
    EXPECT_FALSE(row.gap());  // no candidate
    row.candidate = lane_of(-6.0);
    EXPECT_FALSE(row.gap());  // not proven
    row.status = SolveStatus::optimal;
    EXPECT_DOUBLE_EQ(*row.gap(), 0.25);
    EXPECT_FALSE(row.is_optimal(row.candidate));
    row.optimum->objective = 0.5;
    row.candidate->objective = 0.75;
    EXPECT_DOUBLE_EQ(*row.gap(), 0.25);
    row.candidate->objective = 0.5 - 1e-9;  // a difference within rounding is not better than the optimum
    EXPECT_DOUBLE_EQ(*row.gap(), 0.0);
    EXPECT_TRUE(row.is_optimal(row.candidate));
}

TEST(Optimality, FindsTheStraightLaneOptimal) {
    const std::vector<AnnotatedScene> scenes{straight_scene()};
    const std::vector<OptimalityRow> rows = optimality_rows(scenes, {}, {});
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0].status, SolveStatus::optimal);
    EXPECT_TRUE(rows[0].is_optimal(rows[0].candidate));
    EXPECT_TRUE(rows[0].is_optimal(rows[0].beam));
    ASSERT_TRUE(rows[0].beside);
    EXPECT_EQ(rows[0].beside->iou, 1.0);
    EXPECT_EQ(rows[0].optimum->iou, 1.0);
    EXPECT_EQ(rows[0].candidate->category, Category::ground_truth);
    EXPECT_GE(rows[0].candidates, rows[0].feasible);
    EXPECT_GE(rows[0].feasible, 1u);
}

TEST(Optimality, NoCandidateBeatsTheProvenOptimum) {
    const SceneSet set = some_scenes({0.0, 0.3});
    OptimalityOptions options;
    options.nearest = 14;
    const std::vector<OptimalityRow> rows = optimality_rows(set.scenes, set.tracks, options);
    ASSERT_EQ(rows.size(), set.scenes.size());
    std::size_t compared = 0;
    for (const OptimalityRow& row : rows) {
        SCOPED_TRACE(row.scene->scene.id);
        EXPECT_EQ(row.candidate.has_value(), row.feasible > 0);
        if (!row.gap()) continue;
        ++compared;
        EXPECT_GE(*row.candidate->objective, *row.optimum->objective - 1e-6);
        // What the ranking chose is one of the candidates.
        if (row.choice && row.choice->objective) {
            EXPECT_GE(*row.choice->objective, *row.candidate->objective - 1e-9);
        }
    }
    EXPECT_GT(compared, rows.size() / 2);
    EXPECT_THAT(optimality_table(rows), testing::ContainsRegex("\ndefault +- +30.0 "));
}

/// Each objective has its own optimum, on the same scenes, and the lanes of others cost no less.
TEST(Optimality, HoldsLanesAgainstTheOptimaOfSeveralObjectives) {
    const SceneSet set = some_scenes({0.3});
    OptimalityOptions options;
    options.costs = {{}, {"shape", *rld_parameter_set("shape")}, {"learned", *rld_parameter_set("learned")}};
    options.beam_width = 30;
    const std::vector<OptimalityRow> rows = optimality_rows(set.scenes, set.tracks, options);
    ASSERT_EQ(rows.size(), 3 * set.scenes.size());
    std::size_t beams = 0;
    std::size_t beside = 0;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const OptimalityRow& row = rows[k];
        SCOPED_TRACE(row.scene->scene.id + " " + row.costs);
        EXPECT_EQ(row.scene, &set.scenes[k / 3]);
        EXPECT_EQ(row.costs, options.costs[k % 3].name);
        ASSERT_EQ(row.status, SolveStatus::optimal);
        EXPECT_TRUE(row.optimum->usable);
        for (const std::optional<JudgedLane>* lane : {&row.beam, &row.candidate, &row.choice, &row.beside}) {
            if (!*lane || !(*lane)->objective) continue;
            EXPECT_GE(*(*lane)->objective, *row.optimum->objective - 1e-6);
        }
        // The answers of methods do not know the objective.
        EXPECT_EQ(row.beside->iou, rows[k - k % 3].beside->iou);
        if (row.beam) ++beams;
        if (row.gap_of(row.beside)) ++beside;
    }
    EXPECT_GT(beams, rows.size() / 2);
    EXPECT_GT(beside, rows.size() / 2);
    const std::string table = optimality_table(rows);
    EXPECT_THAT(table, testing::AllOf(testing::ContainsRegex("\nlearned +- +30.0 "),
                                      testing::ContainsRegex("\nshape +beam +none ")));
    EXPECT_LT(table.find("\nshape"), table.find("\nlearned"));
}

/// Of lanes that are as good as the optimum, better and forbidden: counted by their gap.
TEST(Optimality, TellsQualityByGap) {
    const std::vector<AnnotatedScene> scenes{straight_scene()};
    std::vector<OptimalityRow> rows(3);
    for (OptimalityRow& row : rows) {
        row.scene = scenes.data();
        row.costs = "a";
        row.status = SolveStatus::optimal;
        row.optimum = lane_of(-10.0);
        row.optimum->usable = false;
        row.beam = lane_of(-10.0);
        row.beam->usable = true;
        row.beam->category = Category::ground_truth;
        row.beam->iou = 0.5;
    }
    rows[1].beam->objective = -9.5;
    rows[2].beam->objective.reset();
    const std::string table = optimality_table(rows);
    for (const char* gap : {"none", "to 10 %", "forbidden"}) {
        EXPECT_THAT(table, testing::ContainsRegex("a +beam +" + std::string(gap) +
                                                  " +1 +0.0 / 0.0 / 0.0 +100.0 / 100.0 / 50.0\n"));
    }
    EXPECT_THAT(table, testing::Not(HasSubstr("to 1 %")));
}

TEST(Optimality, DoesNotDependOnThreads) {
    const SceneSet set = some_scenes({0.2});
    const auto gaps = [&](unsigned threads) {
        OptimalityOptions options;
        options.threads = threads;
        std::vector<double> all;
        for (const OptimalityRow& row : optimality_rows(set.scenes, set.tracks, options)) {
            all.push_back(row.gap().value_or(-1.0));
        }
        return all;
    };
    EXPECT_EQ(gaps(1), gaps(3));
}

TEST(Optimality, WantsADetectorThatEnumerates) {
    const std::vector<AnnotatedScene> scenes{straight_scene()};
    OptimalityOptions options;
    for (const char* detector : {"rld-pair", "magic"}) {
        options.detector = detector;
        EXPECT_THROW((void)optimality_rows(scenes, {}, options), InvalidInput) << detector;
    }
}

}  // namespace
}  // namespace conelane::experiments
