// The evaluation of rows in the study of backends: refuted claims, permutations, measures, features, ASlib.

#include "experiments/studies/backend_measures.hpp"

#include "evaluation/formats/scene_set.hpp"
#include "experiments/studies/aslib.hpp"
#include "experiments/studies/features.hpp"
#include "experiments/studies/peak_memory.hpp"
#include "experiments/studies/reference_problem.hpp"
#include "tests/support/file_test.hpp"
#include "tests/support/straight_scene.hpp"
#include "tests/support/testing.hpp"

namespace conelane::experiments {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kLimit_ms = 100.0;

BackendRow row_of(const AnnotatedScene& scene, const std::string& solver, SolveStatus status,
                  std::optional<double> objective, double latency_ms, std::size_t permutation = 0) {
    BackendRow row;
    row.scene = &scene;
    row.cones = row.size = 6;
    row.backend = Backend{solver};
    row.status = status;
    row.objective = objective;
    row.bound = status == SolveStatus::optimal ? objective : std::nullopt;
    row.latency_ms = latency_ms;
    row.permutation = permutation;
    return row;
}

TEST(RefutedClaims, AreThoseThatACheckedLaneGraphContradicts) {
    const std::vector<AnnotatedScene> scenes(2, straight_scene());
    std::vector<BackendRow> rows{row_of(scenes[0], "a", SolveStatus::optimal, -5.0, 1.0),
                                 row_of(scenes[0], "b", SolveStatus::optimal, -5.0 + 4e-6, 1.0),
                                 row_of(scenes[0], "c", SolveStatus::optimal, -4.9, 1.0),
                                 row_of(scenes[0], "d", SolveStatus::infeasible, {}, 1.0),
                                 row_of(scenes[0], "e", SolveStatus::feasible, -4.0, 1.0),
                                 row_of(scenes[0], "f", SolveStatus::error, -9.0, 1.0),
                                 row_of(scenes[1], "a", SolveStatus::infeasible, {}, 1.0)};
    rows[4].bound = -4.5;
    mark_refuted_claims(rows);
    std::string refuted;
    for (const BackendRow& row : rows) refuted += row.refuted ? row.backend.solver : "-";
    EXPECT_EQ(refuted, "--cde--");
    EXPECT_THAT(rows[2].message, HasSubstr("claims the optimum -4.9 where a has a lane graph of -5"));
    EXPECT_THAT(rows[3].message, HasSubstr("no lane graph"));
    EXPECT_THAT(rows[4].message, HasSubstr("the bound -4.5"));
    EXPECT_THAT(errors_among(rows).lines(), testing::SizeIs(4));
}

TEST(RefutedClaims, AndErrorsCountInEveryOrder) {
    const std::vector<AnnotatedScene> scenes(1, straight_scene());
    std::vector<BackendRow> rows{row_of(scenes[0], "a", SolveStatus::optimal, -5.0, 1.0),
                                 row_of(scenes[0], "b", SolveStatus::optimal, -5.0, 1.0),
                                 row_of(scenes[0], "b", SolveStatus::optimal, -4.0, 1.0, 1),
                                 row_of(scenes[0], "b", SolveStatus::error, {}, 1.0, 2)};
    mark_refuted_claims(rows);
    std::istringstream table(backend_table(rows));
    std::vector<std::string> words(8);
    while (words[1] != "b" && std::getline(table, words[0])) {
        std::istringstream line(words[0]);
        for (std::string& word : words) line >> word;
    }
    // Size and backend; scenes, optimal, infeasible, unproven, errors, refuted.
    EXPECT_THAT(words, ElementsAre("6", "b", "1", "1", "0", "0", "1", "1"));
    const std::vector<BackendSummary> summaries = measures_of(rows, kLimit_ms).summaries;
    ASSERT_EQ(summaries.size(), 2U);
    EXPECT_EQ(summaries[1].runs, 1U) << "the other backend has no other orders";
    EXPECT_EQ(summaries[1].refuted, 1U);
    EXPECT_EQ(summaries[1].errors, 2U);
}

/// Two backends on two scenes in two orders; "b" fails once and is refuted once.
TEST(BackendMeasuresOfRows, AreOfTheRunsThatAllHave) {
    const std::vector<AnnotatedScene> scenes(2, straight_scene());
    using Status = SolveStatus;
    std::vector<BackendRow> rows;
    for (const std::size_t order : {0, 1}) {
        const double more = 2.0 * static_cast<double>(order);
        rows.push_back(row_of(scenes[0], "a", Status::optimal, -5.0, 2.0 + more, order));
        rows.push_back(row_of(scenes[1], "a", Status::optimal, -4.0, 4.0, order));
        rows.push_back(row_of(scenes[0], "b", Status::optimal, -5.0, 1.0, order));
    }
    rows.push_back(row_of(scenes[1], "b", Status::optimal, -4.0, 130.0, 0));  // too late
    rows.push_back(row_of(scenes[1], "b", Status::optimal, -3.0, 8.0, 1));    // not the optimum
    rows.push_back(row_of(scenes[1], "a", Status::optimal, -4.0, 1.0, 2));    // "b" has no third order
    rows[0].steps = {{1.0, -2.5, -10.0}, {2.0, -5.0, -5.0}};
    mark_refuted_claims(rows);
    const BackendMeasures measures = measures_of(rows, kLimit_ms);
    ASSERT_EQ(measures.summaries.size(), 2U);
    const BackendSummary& a = measures.summaries[0];
    const BackendSummary& b = measures.summaries[1];
    EXPECT_EQ(a.runs, 4U);
    EXPECT_EQ(a.scenes, 2U);
    EXPECT_EQ(a.solved, 4U);
    EXPECT_EQ(b.solved, 2U);
    EXPECT_EQ(b.errors, 1U);
    EXPECT_EQ(b.refuted, 1U);
    EXPECT_NEAR(a.geometric_ms, std::pow(3.0 * 5.0 * 5.0 * 5.0, 0.25) - 1.0, 1e-9);
    EXPECT_NEAR(b.geometric_ms, std::pow(2.0 * 2.0 * 101.0 * 101.0, 0.25) - 1.0, 1e-9);
    EXPECT_DOUBLE_EQ(b.par1_ms, (1.0 + 1.0 + 100.0 + 100.0) / 4.0);
    EXPECT_DOUBLE_EQ(b.par2_ms, (1.0 + 1.0 + 200.0 + 200.0) / 4.0);
    EXPECT_DOUBLE_EQ(b.par10_ms, (1.0 + 1.0 + 1000.0 + 1000.0) / 4.0);
    EXPECT_EQ(a.common, 2U);
    EXPECT_NEAR(*a.common_geometric_ms, std::sqrt(3.0 * 5.0) - 1.0, 1e-9);
    EXPECT_EQ(a.won, 2U);
    EXPECT_EQ(b.won, 2U);
    // Scene 0: 2 and 4 ms; scene 1: 4, 4 and 1 ms.
    EXPECT_NEAR(*a.variability, (std::sqrt(2.0) / 3.0 + std::sqrt(3.0) / 3.0) / 2.0, 1e-9);
    EXPECT_EQ(a.integrals, 1U);
    EXPECT_DOUBLE_EQ(*a.primal_integral_ms, 1.0 + 0.5);
    EXPECT_DOUBLE_EQ(*a.dual_integral_ms, 1.0 + 0.5);
    EXPECT_FALSE(b.primal_integral_ms);
    EXPECT_DOUBLE_EQ(a.profile.front(), 0.5);
    EXPECT_DOUBLE_EQ(a.profile.back(), 1.0);
    ASSERT_EQ(measures.pairs.size(), 1U);
    EXPECT_EQ(measures.pairs[0].scenes, 2U);
    EXPECT_NEAR(measures.pairs[0].ratio, std::pow(2.0 * 4.0 * 4.0 * 4.0 / (100.0 * 100.0), 0.25), 1e-9);
    ASSERT_EQ(measures.selections.size(), 1U);
    EXPECT_EQ(measures.selections[0].single_best, "a");
    EXPECT_DOUBLE_EQ(measures.selections[0].virtual_par10_ms, (1.0 + 1.0 + 4.0 + 4.0) / 4.0);
    EXPECT_THAT(measures_table(measures, {}), HasSubstr("PAR10"));
    ASSERT_FALSE(measures.gaps.empty());
    EXPECT_EQ(measures.gaps.front().mean_primal_gap, 1.0);
    EXPECT_EQ(measures.gaps.back().mean_primal_gap, 0.0);
}

SceneSet some_scenes() {
    SceneOptions options;
    options.false_positive_rates = {0.3};
    options.ranges_m = {25.0};
    options.every_m = 40.0;
    return make_scene_set({"generated:kidney", "generated:straight"}, options);
}

/// Every order has the optimum of the original scene, for every solver.
TEST(Permutations, DoNotChangeAnOptimum) {
    const SceneSet set = some_scenes();
    BackendOptions options;
    options.sizes = {10};
    options.permutations = 2;
    options.gap_limits_ms = {0.1, 1.0};
    options.time_limit_ms = 60'000.0;
    options.backends = {backend_of("path-pair"), backend_of("cbc"), backend_of("cbc-main"),
                        backend_of("clp-bb/paper")};
    const BackendResults results = backend_results(set.scenes, options);
    std::map<const AnnotatedScene*, double> optimum;
    std::map<std::size_t, std::size_t> orders;
    for (const BackendRow& row : results.rows) {
        EXPECT_FALSE(row.refuted) << row.message;
        ++orders[row.permutation];
        ASSERT_TRUE(row.status == SolveStatus::optimal || row.status == SolveStatus::infeasible)
            << row.message;
        const double value = row.objective.value_or(1e9);
        EXPECT_NEAR(optimum.try_emplace(row.scene, value).first->second, value, 1e-6);
        EXPECT_EQ(row.steps.empty(), row.permutation > 0);
    }
    EXPECT_EQ(orders.size(), 3U);
    EXPECT_EQ(orders[1], orders[0]);
    ASSERT_EQ(results.blocks.size(), 4U);
    for (const BackendBlock& block : results.blocks) {
        EXPECT_GT(block.reference_ms, 0.0);
        EXPECT_FALSE(block.version.empty());
    }
}

class AslibScenario : public FileTest {};

TEST_F(AslibScenario, HasEveryRunAndInstance) {
    const SceneSet set = some_scenes();
    BackendOptions options;
    options.sizes = {8};
    options.permutations = 1;
    options.backends = {backend_of("path-pair"), backend_of("clp-bb")};
    const std::vector<BackendRow> rows = backend_rows(set.scenes, options);
    write_aslib_scenario(path("aslib"), rows, options);
    const auto data_lines = [&](const std::string& name) {
        const std::string text = text_of(path("aslib") / name);
        const std::size_t data = text.find("@DATA\n");
        EXPECT_NE(data, std::string::npos) << name;
        return static_cast<std::size_t>(
                   std::count(text.begin() + static_cast<std::ptrdiff_t>(data), text.end(), '\n')) -
               1;
    };
    EXPECT_EQ(data_lines("algorithm_runs.arff"), rows.size());
    const std::size_t instances = rows.size() / 4;
    for (const char* name :
         {"feature_values.arff", "feature_runstatus.arff", "feature_costs.arff", "cv.arff"})
        EXPECT_EQ(data_lines(name), instances) << name;
    EXPECT_THAT(text_of(path("aslib") / "description.txt"), HasSubstr("'clp-bb/tight':"));
    EXPECT_THAT(text_of(path("aslib") / "algorithm_runs.arff"), HasSubstr(" n=8',2,'path-pair',"));
}

/// A straight lane of 20 cones, 4 m apart along and 3.5 m across: its 18 edges along, 10 across, and some
/// diagonals; the relaxation is no better than the optimum.
TEST(Features, CountAndBound) {
    const std::vector<AnnotatedScene> scenes{straight_scene()};
    ConeSetOptions options;
    options.sizes = {20};
    options.time_limit_ms = 60'000.0;
    const std::vector<FeatureRow> rows = feature_rows(scenes, options);
    ASSERT_EQ(rows.size(), 1U);
    const InstanceFeatures::Problem& problem = rows[0].features.problem;
    EXPECT_EQ(problem.cones, 20U);
    EXPECT_GE(problem.edges, 28U);
    EXPECT_DOUBLE_EQ(problem.edge_density, static_cast<double>(problem.edges) / 190.0);
    EXPECT_DOUBLE_EQ(problem.mean_degree, static_cast<double>(problem.edges) / 10.0);
    ASSERT_TRUE(rows[0].features.relaxation);
    EXPECT_GE(*rows[0].lp_gap, 0.0);
    EXPECT_LE(rows[0].features.relaxation->degenerate, 1.0);
    EXPECT_EQ(named(rows[0].features).size(), named({}).size());
    EXPECT_EQ(std::string(named({})[kProblemFeatures].name), "columns");
    EXPECT_THAT(feature_table(rows), HasSubstr("LP gap"));
}

TEST(PeakMemory, SeesWhatIsAllocatedAndFreed) {
    const PeakMemory memory;
    if (!memory.rise_bytes()) GTEST_SKIP() << "the system does not tell";
    constexpr std::size_t kBytes = std::size_t{64} << 20U;
    { const std::vector<char> block(kBytes, 1); }
    EXPECT_GE(*memory.rise_bytes(), kBytes * 9 / 10);
    EXPECT_LT(*memory.rise_bytes(), kBytes * 2);
}

TEST(ReferenceProblems, VaryByTheirSpread) {
    EXPECT_EQ(coefficient_of_variation(std::vector<double>{3.0}), 0.0);
    EXPECT_DOUBLE_EQ(coefficient_of_variation(std::vector<double>{2.0, 4.0, 6.0}), 0.5);
}

}  // namespace
}  // namespace conelane::experiments
