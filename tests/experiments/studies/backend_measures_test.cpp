// The evaluation of rows in the study of backends: refuted claims, permutations, measures.

#include "experiments/studies/backend_measures.hpp"

#include "experiments/studies/machine.hpp"
#include "tests/support/straight_scene.hpp"

namespace conelane::experiments {
namespace {

constexpr double kLimit_ms = 100.0;

SolveRow row_of(const AnnotatedScene& scene, const std::string& solver, SolveStatus status,
                std::optional<double> objective, double latency_ms, std::size_t permutation = 0) {
    SolveRow row{.scene = &scene};
    row.cones = row.size = 6;
    row.backend = Backend{solver};
    row.status = status;
    row.objective = objective;
    row.bound = status == SolveStatus::optimal ? objective : std::nullopt;
    row.latency_ms = latency_ms;
    row.permutation = permutation;
    return row;
}

/// The measures of this kind.
std::vector<Json> rows_of_kind(const std::string& kind, const std::vector<SolveRow>& rows,
                               const std::string& reference = {}) {
    StudyResult result;
    add_measures(result, {rows, {}}, kLimit_ms, reference);
    std::erase_if(result.rows, [&](const Json& row) { return row.at("row") != kind; });
    return result.rows;
}

TEST(RefutedClaims, AreThoseThatACheckedLaneGraphContradicts) {
    const std::vector<AnnotatedScene> scenes(2, straight_scene());
    std::vector<SolveRow> rows{row_of(scenes[0], "a", SolveStatus::optimal, -5.0, 1.0),
                               row_of(scenes[0], "b", SolveStatus::optimal, -5.0 + 4e-6, 1.0),
                               row_of(scenes[0], "c", SolveStatus::optimal, -4.9, 1.0),
                               row_of(scenes[0], "d", SolveStatus::infeasible, {}, 1.0),
                               row_of(scenes[0], "e", SolveStatus::feasible, -4.0, 1.0),
                               row_of(scenes[0], "f", SolveStatus::error, -9.0, 1.0),
                               row_of(scenes[1], "a", SolveStatus::infeasible, {}, 1.0)};
    rows[4].bound = -4.5;
    mark_refuted_claims(rows);
    std::string refuted;
    for (const SolveRow& row : rows) refuted += row.refuted ? row.backend.solver : "-";
    EXPECT_EQ(refuted, "--cde--");
    EXPECT_THAT(rows[2].message, HasSubstr("claims the optimum -4.9 where a has a lane graph of -5"));
    EXPECT_THAT(rows[3].message, HasSubstr("no lane graph"));
    EXPECT_THAT(rows[4].message, HasSubstr("the bound -4.5"));
    EXPECT_THAT(errors_among(rows).lines(), testing::SizeIs(4));
}

TEST(RefutedClaims, AndErrorsCountInEveryOrder) {
    const std::vector<AnnotatedScene> scenes(1, straight_scene());
    std::vector<SolveRow> rows{row_of(scenes[0], "a", SolveStatus::optimal, -5.0, 1.0),
                               row_of(scenes[0], "b", SolveStatus::optimal, -5.0, 1.0),
                               row_of(scenes[0], "b", SolveStatus::optimal, -4.0, 1.0, 1),
                               row_of(scenes[0], "b", SolveStatus::error, {}, 1.0, 2)};
    mark_refuted_claims(rows);
    EXPECT_THAT(errors_among(rows).lines(), ElementsAre(HasSubstr("b n=6: 2 of 3 answers")));
    const std::vector<Json> summaries = rows_of_kind("summary", rows);
    ASSERT_EQ(summaries.size(), 2U);
    EXPECT_EQ(summaries[1]["runs"], 1U) << "the other backend has no other orders";
    EXPECT_EQ(summaries[1]["refuted"], 1U);
    EXPECT_EQ(summaries[1]["errors"], 2U);
}

/// Two backends on two scenes in two orders; "b" fails once and is refuted once.
TEST(BackendMeasuresOfRows, AreOfTheRunsThatAllHave) {
    std::vector<AnnotatedScene> scenes(2, straight_scene());
    scenes[1].track = "another course";
    using Status = SolveStatus;
    std::vector<SolveRow> rows;
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
    const std::vector<Json> summaries = rows_of_kind("summary", rows);
    ASSERT_EQ(summaries.size(), 2U);
    const Json &a = summaries[0], &b = summaries[1];
    EXPECT_EQ(a.at("runs"), 4U);
    EXPECT_EQ(a.at("scenes"), 2U);
    EXPECT_EQ(a.at("solved"), 4U);
    EXPECT_EQ(b.at("solved"), 2U);
    EXPECT_EQ(b.at("errors"), 1U);
    EXPECT_EQ(b.at("refuted"), 1U);
    EXPECT_NEAR(a.at("geometric_ms"), std::pow(3.0 * 5.0 * 5.0 * 5.0, 0.25) - 1.0, 1e-9);
    EXPECT_NEAR(b.at("geometric_ms"), std::pow(2.0 * 2.0 * 101.0 * 101.0, 0.25) - 1.0, 1e-9);
    EXPECT_DOUBLE_EQ(b.at("par10_ms"), (1.0 + 1.0 + 1000.0 + 1000.0) / 4.0);
    const auto expect_interval = [](const Json& interval, double low, double high) {
        EXPECT_NEAR(interval[0], low, 1e-9);
        EXPECT_NEAR(interval[1], high, 1e-9);
    };
    expect_interval(a.at("geometric_ms_interval"), std::sqrt(3.0 * 5.0) - 1.0, 4.0);
    expect_interval(b.at("par10_ms_interval"), 1.0, 1000.0);
    EXPECT_DOUBLE_EQ(a.at("contribution_ms"), 500.5 - 2.5);  // without it only "b" is left
    EXPECT_DOUBLE_EQ(b.at("contribution_ms"), 3.5 - 2.5);
    EXPECT_EQ(a.at("won"), 2U);
    EXPECT_EQ(b.at("won"), 2U);
    // Scene 0: 2 and 4 ms; scene 1: 4, 4 and 1 ms.
    EXPECT_NEAR(a.at("variability"), (std::sqrt(2.0) / 3.0 + std::sqrt(3.0) / 3.0) / 2.0, 1e-9);
    EXPECT_EQ(a.at("integrals"), 1U);
    EXPECT_DOUBLE_EQ(a.at("primal_integral_ms"), 1.0 + 0.5);
    EXPECT_DOUBLE_EQ(a.at("dual_integral_ms"), 1.0 + 0.5);
    EXPECT_FALSE(b.contains("primal_integral_ms"));
    EXPECT_DOUBLE_EQ(a.at("profile").front(), 0.5);
    EXPECT_DOUBLE_EQ(a.at("profile").back(), 1.0);
    const std::vector<Json> pairs = rows_of_kind("pair", rows);
    ASSERT_EQ(pairs.size(), 1U);
    EXPECT_EQ(pairs[0].at("courses"), 2U);
    EXPECT_EQ(pairs[0].at("second"), "a");
    EXPECT_NEAR(pairs[0].at("ratio"), std::pow(100.0 * 100.0 / (2.0 * 4.0 * 4.0 * 4.0), 0.25), 1e-9);
    expect_interval(pairs[0].at("ratio_interval"), std::sqrt(1.0 / 8.0), 25.0);
    EXPECT_DOUBLE_EQ(pairs[0].at("p_value"), 1.0) << "one course for each of them";
    EXPECT_EQ(rows_of_kind("pair", rows, "b")[0].at("first"), "a");
    const std::vector<Json> selections = rows_of_kind("selection", rows);
    ASSERT_EQ(selections.size(), 1U);
    EXPECT_EQ(selections[0].at("single_best"), "a");
    EXPECT_DOUBLE_EQ(selections[0].at("virtual_par10_ms"), (1.0 + 1.0 + 4.0 + 4.0) / 4.0);
    const std::vector<Json> gaps = rows_of_kind("gap", rows);
    ASSERT_FALSE(gaps.empty());
    EXPECT_EQ(gaps.front().at("mean_primal_gap"), 1.0);
    EXPECT_EQ(gaps.back().at("mean_primal_gap"), 0.0);
}

SceneSet some_scenes() {
    SceneOptions options{.false_positive_rates = {0.3}, .ranges_m = {25.0}, .every_m = 40.0};
    return make_scene_set({"generated:kidney", "generated:straight"}, options);
}

/// Every order has the optimum of the original scene, for every solver.
TEST(Permutations, DoNotChangeAnOptimum) {
    const SceneSet set = some_scenes();
    SolveOptions options{.sizes = {10}, .time_limit_ms = 60'000.0, .with_machine = true};
    options.permutations = 2;
    options.gap_limits_ms = {0.1, 1.0};
    options.backends = {backend_of("path-pair"), backend_of("cbc"), backend_of("cbc-main"),
                        backend_of("clp-bb/paper"), backend_of("cbc")};
    options.backends.back().all_rows = true;
    SolveResults results = solve_scenes(set.scenes, options);
    mark_refuted_claims(results.rows);
    std::map<const AnnotatedScene*, double> optimum;
    std::map<std::size_t, std::size_t> orders;
    for (const SolveRow& row : results.rows) {
        EXPECT_FALSE(row.refuted) << row.message;
        ++orders[row.permutation];
        ASSERT_TRUE(row.is_proven()) << row.message;
        const double value = row.objective.value_or(1e9);
        EXPECT_NEAR(optimum.try_emplace(row.scene, value).first->second, value, 1e-6);
        EXPECT_EQ(row.steps.empty(), row.permutation > 0);
    }
    EXPECT_EQ(orders.size(), 3U);
    EXPECT_EQ(orders[1], orders[0]);
    std::vector<std::string> treatments;
    for (const SolveBlock& block : results.blocks) {
        EXPECT_GT(block.reference_ms, 0.0);
        EXPECT_FALSE(block.version.empty());
        treatments.push_back(block.treatment);
    }
    EXPECT_THAT(treatments, testing::ElementsAre("no program; no start",
                                                 "tight rows, on demand; settings: tuned; no start",
                                                 "tight rows, on demand; settings: defaults; no start",
                                                 "printed rows, on demand; settings: tuned; no start",
                                                 "tight rows, all; settings: tuned; no start"));
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
