// Graph search and exact search under one objective.

#include "experiments/studies/optimality.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/scenes/scene_set.hpp"
#include "tests/support/straight_scene.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

TEST(OptimalityRow, GapIsRelativeToTheOptimumButNotToLessThanOne) {
    OptimalityRow row;
    row.optimum = JudgedLane{-8.0};
    EXPECT_FALSE(row.gap());  // no candidate
    row.candidate = JudgedLane{-6.0};
    EXPECT_FALSE(row.gap());  // not proven
    row.status = SolveStatus::optimal;
    EXPECT_DOUBLE_EQ(*row.gap(), 0.25);
    EXPECT_FALSE(row.is_optimal());
    row.optimum->objective = 0.5;
    row.candidate->objective = 0.75;
    EXPECT_DOUBLE_EQ(*row.gap(), 0.25);
    row.candidate->objective = 0.5 - 1e-9;  // a difference within rounding is not better than the optimum
    EXPECT_DOUBLE_EQ(*row.gap(), 0.0);
    EXPECT_TRUE(row.is_optimal());
}

TEST(Optimality, FindsTheStraightLaneOptimal) {
    const std::vector<AnnotatedScene> scenes{straight_scene()};
    const std::vector<OptimalityRow> rows = optimality_rows(scenes, {}, {});
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0].status, SolveStatus::optimal);
    EXPECT_TRUE(rows[0].is_optimal());
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
    EXPECT_THAT(optimality_table(rows), HasSubstr("\n30.0 "));
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
