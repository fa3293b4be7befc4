// Studies: what is listed, the table they share, and the exact backends under one objective.

#include "conelane/invalid_input.hpp"
#include "evaluation/formats/scene_set.hpp"
#include "experiments/studies/anytime.hpp"
#include "experiments/studies/backends.hpp"
#include "experiments/studies/cone_sets.hpp"
#include "experiments/studies/growth.hpp"
#include "experiments/studies/study.hpp"
#include "experiments/studies/text_table.hpp"
#include "solvers/registry.hpp"
#include "tests/support/straight_scene.hpp"
#include "tests/support/testing.hpp"

namespace conelane::experiments {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;

SceneSet some_scenes(std::vector<double> rates) {
    SceneOptions options;
    options.false_positive_rates = std::move(rates);
    options.ranges_m = {25.0};
    options.every_m = 20.0;
    return make_scene_set({"generated:kidney", "generated:straight"}, options);
}

TEST(Studies, HaveANameOfTheirOwnAQuestionAndAProtocol) {
    std::set<std::string_view> names;
    for (const auto& study : make_studies()) {
        const StudyDescription& description = study->description();
        EXPECT_TRUE(names.insert(description.name).second) << description.name;
        EXPECT_THAT(description.name, testing::MatchesRegex("[a-z-]+"));
        EXPECT_TRUE(description.question.ends_with('?')) << description.question;
        EXPECT_FALSE(description.protocol.empty());
    }
    EXPECT_GE(names.size(), 5U);
}

TEST(TextTable, MakesEveryColumnAsWideAsItsWidestCell) {
    TextTable table({{"n"}, {"solver", true}, {"ms"}});
    table.add({"6", "cbc", fixed(12.345, 1)});
    table.add({"12", "path-pair", fixed({}, 1)});
    EXPECT_EQ(table.text(),
              " n solver      ms\n"
              " 6 cbc       12.3\n"
              "12 path-pair    -\n");
    EXPECT_EQ(percent(share(1, 3), 2), "33.33");
    EXPECT_EQ(percent(share(0, 0), 2), "-");
}

TEST(ConeSets, AreSpreadEvenlyOverTheScenesThatHaveThem) {
    std::vector<AnnotatedScene> scenes(10, straight_scene());
    const auto any = [](const AnnotatedScene&) { return true; };
    EXPECT_EQ(scenes_of_size(scenes, 20, {}, any).size(), 10U);
    EXPECT_TRUE(scenes_of_size(scenes, 21, {}, any).empty());
    EXPECT_THAT(scenes_of_size(scenes, 6, 3, any), ElementsAre(&scenes[0], &scenes[3], &scenes[6]));
    const auto not_first = [&](const AnnotatedScene& scene) { return &scene != scenes.data(); };
    EXPECT_THAT(scenes_of_size(scenes, 6, 1, not_first), ElementsAre(&scenes[1]));
}

TEST(Backends, AreAllExactSolversOfTheRegistry) {
    std::vector<std::string> exact;
    for (const RldSolverEntry& entry : rld_solvers()) {
        if (entry.has(SolverTrait::exact)) exact.emplace_back(entry.name);
    }
    std::vector<std::string> found;
    for (const Backend& backend : exact_backends()) found.push_back(backend.solver);
    EXPECT_EQ(found, exact);
}

TEST(Backends, HaveNamesWithAndWithoutAFormulation) {
    EXPECT_EQ(backend_of("path-pair").label(), "path-pair");
    EXPECT_EQ(backend_of("cbc").label(), "cbc/tight");
    EXPECT_EQ(backend_of("cbc/paper").label(), "cbc/paper");
    for (const char* bad : {"magic", "lp-rounding", "path-pair/tight", "cbc/", "cbc/loose", "/tight", ""}) {
        EXPECT_THROW((void)backend_of(bad), InvalidInput) << bad;
    }
}

TEST(Backends, SolveOnlyTheSizesThatTheyTake) {
    const std::vector<AnnotatedScene> scenes{straight_scene()};
    BackendOptions options;
    options.backends = {backend_of("exhaustive"), backend_of("path-pair")};
    options.sizes = {6, 10};
    std::vector<std::pair<std::size_t, std::string>> solved;
    std::vector<SolveStatus> statuses;
    for (const BackendRow& row : backend_rows(scenes, options)) {
        solved.emplace_back(row.cones, row.backend.solver);
        statuses.push_back(row.status);
    }
    using Solved = std::pair<std::size_t, std::string>;
    EXPECT_THAT(solved,
                ElementsAre(Solved(6, "exhaustive"), Solved(6, "path-pair"), Solved(10, "path-pair")));
    EXPECT_THAT(statuses, Each(SolveStatus::optimal));
}

/// `conelane study` ends with 1 if a backend answers none of the scenes of a size.
TEST(Backends, OneThatAnswersNoSceneOfASizeIsNamed) {
    const AnnotatedScene scene = straight_scene();
    std::vector<BackendRow> rows(4);
    for (std::size_t k = 0; k < rows.size(); ++k) {
        rows[k].scene = &scene;
        rows[k].backend = backend_of("cbc");
        rows[k].cones = k < 2 ? 6 : 8;
        rows[k].size = rows[k].cones;
        rows[k].status = k == 3 ? SolveStatus::error : SolveStatus::optimal;
    }
    rows[3].message = "out of paper";
    EXPECT_FALSE(errors_among(rows).any_answered_nothing());
    EXPECT_THAT(errors_among(rows).lines(), ElementsAre(HasSubstr("cbc/tight n=8: 1 of 2 answers")));
    rows[2].status = SolveStatus::error;
    EXPECT_TRUE(errors_among(rows).any_answered_nothing());
}

TEST(Backends, AgreeWithAndWithoutAStart) {
    const SceneSet set = some_scenes({0.2});
    BackendOptions options;
    options.sizes = {8, 10};
    std::vector<Backend> backends = exact_backends();
    backends.push_back(backend_of("cbc-main/paper"));
    for (Backend backend : backends) {
        options.backends.push_back(backend);
        backend.warm_start = true;
        options.backends.push_back(backend);
    }
    const std::vector<BackendRow> rows = backend_rows(set.scenes, options);
    std::map<std::pair<std::size_t, std::string>, double> optimum;
    std::set<std::string> labels;
    for (const BackendRow& row : rows) {
        SCOPED_TRACE(row.scene->scene.id + " " + row.backend.label());
        labels.insert(row.backend.label());
        EXPECT_THAT(row.message, "");
        if (row.status == SolveStatus::stopped || row.status == SolveStatus::feasible) continue;
        ASSERT_TRUE(row.status == SolveStatus::optimal || row.status == SolveStatus::infeasible);
        const double value = row.status == SolveStatus::optimal ? *row.objective : 1e9;
        const auto known = optimum.try_emplace({row.cones, row.scene->scene.id}, value).first;
        EXPECT_NEAR(value, known->second, 1e-6);
    }
    EXPECT_EQ(labels.size(), options.backends.size());
    EXPECT_TRUE(labels.contains("path-pair"));
    EXPECT_TRUE(labels.contains("cbc-main/paper warm"));
}

TEST(Backends, LeaveOutScenesWithFewerCones) {
    const std::vector<AnnotatedScene> scenes{straight_scene()};  // 20 cones
    BackendOptions options;
    options.backends = {Backend{"path-pair"}};
    options.sizes = {20, 21};
    const std::vector<BackendRow> rows = backend_rows(scenes, options);
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0].cones, 20u);
    options.backends = {Backend{"magic"}};
    EXPECT_THROW((void)backend_rows(scenes, options), InvalidInput);
}

TEST(Anytime, GapIsFromTheBoundToTheBestLaneGraphKnown) {
    AnytimeRow row;
    row.objective = -18.0;
    row.best_known = -20.0;
    row.bound = -25.0;
    EXPECT_DOUBLE_EQ(proven_gap(row).value(), 0.25);
    row.proven = true;
    EXPECT_EQ(proven_gap(row), 0.0);
    row.proven = false;
    row.best_known = -0.5;  // the gap is not divided by small costs
    row.bound = -1.0;
    EXPECT_DOUBLE_EQ(proven_gap(row).value(), 0.5);
    row.bound.reset();
    EXPECT_FALSE(proven_gap(row));
}

TEST(Anytime, WhatIsProvenStaysProven) {
    const std::vector<AnnotatedScene> scenes(3, straight_scene());
    AnytimeOptions options;
    options.limits_ms = {1e-6, 5000.0, 6000.0};
    options.limit = 2;
    const std::vector<AnytimeRow> rows = anytime_rows(scenes, options);
    ASSERT_EQ(rows.size(), 6U);
    for (std::size_t k = 0; k < rows.size(); ++k) {
        EXPECT_EQ(rows[k].limit_ms, options.limits_ms[k % 3]);
        EXPECT_EQ(rows[k].proven, k % 3 > 0);
        EXPECT_EQ(rows[k].scene, &scenes[k / 3]);
        EXPECT_TRUE(rows[k].best_known);
    }
    EXPECT_EQ(rows[1].objective, rows[2].objective);
    EXPECT_THAT(anytime_table(rows, options.limits_ms), testing::HasSubstr("100.0"));
    options.limits_ms = {10.0, 10.0};
    EXPECT_THROW((void)anytime_rows(scenes, options), InvalidInput);
}

/// A cone every 4 m on both sides of a lane of 3.5 m: each has the one across, those of the ends one
/// neighbour along, all others two; the diagonal is 5.3 m.
TEST(Growth, CountsConesEdgesAndNeighbours) {
    const std::vector<AnnotatedScene> scenes{straight_scene()};
    EXPECT_DOUBLE_EQ(neighbours_per_cone(scenes[0].scene), (16 * 5 + 4 * 3) / 20.0);
    EXPECT_EQ(neighbours_per_cone({}), 0.0);
    GrowthOptions options;
    options.sizes = {6, 20, 30};
    const std::vector<GrowthRow> rows = growth_rows(scenes, options);
    ASSERT_EQ(rows.size(), 2U);  // 6, and all 20
    EXPECT_EQ(rows[0].cones, 6U);
    EXPECT_FALSE(rows[0].all_visible);
    EXPECT_EQ(rows[1].cones, 20U);
    EXPECT_TRUE(rows[1].all_visible);
    EXPECT_GE(rows[1].edges, 18U + 10U);
    for (const GrowthRow& row : rows) {
        EXPECT_TRUE(row.proven);
        EXPECT_GE(row.nodes, 1);
        EXPECT_GT(row.cpu_ms, 0.0);
    }
    EXPECT_THAT(growth_tables(rows), testing::HasSubstr("4-5"));
}

}  // namespace
}  // namespace conelane::experiments
