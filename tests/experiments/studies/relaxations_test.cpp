// The relaxations against the optimum, on a course without false positives.

#include "experiments/studies/relaxations.hpp"

#include "conelane/relaxation_solvers.hpp"
#include "evaluation/formats/scene_set.hpp"
#include "solvers/registry.hpp"
#include "tests/support/testing.hpp"

namespace conelane::experiments {
namespace {

using testing::SizeIs;

std::vector<AnnotatedScene> straight_scenes(double rate) {
    SceneOptions options;
    options.false_positive_rates = {rate};
    options.ranges_m = {30.0};
    options.every_m = 12.0;
    return make_scene_set({"generated:straight"}, options).scenes;
}

RelaxationOptions without_limit(std::vector<std::size_t> sizes) {
    RelaxationOptions options;
    options.sizes = std::move(sizes);
    options.time_limit_ms = 1e6;
    return options;
}

TEST(Relaxations, HoldsEverySolverWithoutProofAgainstPathPair) {
    const auto scenes = straight_scenes(0.3);
    AnswerErrors errors;
    const auto rows = relaxation_rows(scenes, without_limit({8, 12}), errors);
    EXPECT_FALSE(errors.any_answered_nothing());
    const auto heuristics = std::ranges::count_if(
        rld_solvers(), [](const RldSolverEntry& entry) { return !entry.has(SolverTrait::exact); });
    ASSERT_GT(heuristics, 0);
    ASSERT_THAT(rows, SizeIs(2 * (1 + heuristics)));
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const RelaxationRow& row = rows[i];
        SCOPED_TRACE(row.solver + " " + std::to_string(row.cones));
        const RelaxationRow& exact = row.cones == 8 ? rows[0] : rows[rows.size() / 2];
        EXPECT_EQ(exact.solver, "path-pair");
        EXPECT_EQ(row.scenes, exact.scenes);
        EXPECT_EQ(row.feasible, exact.feasible);
        EXPECT_LE(row.optimal, row.answered);
        EXPECT_LE(row.answered, row.feasible);
        if (row.mean_gap) {
            EXPECT_LE(*row.mean_gap, *row.worst_gap);
            EXPECT_EQ(row.optimal == row.answered, *row.worst_gap < 1e-6);
        }
        EXPECT_LE(row.median_ms, row.p95_ms);
        EXPECT_LE(row.p95_ms, row.worst_ms);
    }
    for (const std::size_t first : {std::size_t{0}, rows.size() / 2}) {
        EXPECT_GT(rows[first].feasible, 3u);
        EXPECT_EQ(rows[first].optimal, rows[first].feasible);
        EXPECT_EQ(rows[first].worst_gap, 0.0);
    }
}

TEST(Relaxations, LeavesOutSizesThatNoSceneHasAndKeepsToTheLimit) {
    const auto scenes = straight_scenes(0.0);
    RelaxationOptions options = without_limit({8, 500});
    options.limit = 2;
    AnswerErrors errors;
    const auto rows = relaxation_rows(scenes, options, errors);
    for (const RelaxationRow& row : rows) {
        EXPECT_EQ(row.cones, 8u);
        EXPECT_EQ(row.scenes, 2u);
        // Other heuristics may not find even this lane.
        if (row.solver == "path-pair" ||
            std::ranges::count(relaxation_solvers(), row.solver, &RldSolverEntry::name) > 0) {
            EXPECT_EQ(row.accurate, 1.0) << row.solver;
        }
    }
    const std::string table = relaxation_table(rows);
    EXPECT_EQ(std::ranges::count(table, '\n'), static_cast<std::ptrdiff_t>(rows.size()) + 1);
}

}  // namespace
}  // namespace conelane::experiments
