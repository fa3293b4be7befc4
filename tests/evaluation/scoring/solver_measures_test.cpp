// Measures of solvers, compared with values computed by hand and by scipy.

#include "evaluation/scoring/solver_measures.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/scoring/statistics.hpp"
#include "tests/support/testing.hpp"

namespace conelane {
namespace {

using testing::DoubleNear;

constexpr double kLimit_ms = 100.0;

/// Three solvers on four runs. The first is steady, the second is fast or fails, the third is the only one
/// that solves the last run; nobody solves the third run.
std::vector<std::vector<SolverRun>> three_solvers() {
    const SolverRun lost{kLimit_ms, false};
    return {{{8.0, true}, {8.0, true}, lost, lost},
            {{2.0, true}, lost, lost, lost},
            {{16.0, true}, {32.0, true}, {130.0, false}, {64.0, true}}};
}

TEST(SolverMeasures, FailuresCountAtTheLimitOrAMultiple) {
    const auto runs = three_solvers();
    EXPECT_THAT(penalised_times_ms(runs[2], kLimit_ms), ElementsAre(16.0, 32.0, 100.0, 64.0));
    EXPECT_DOUBLE_EQ(penalised_average_ms(runs[0], kLimit_ms, 2.0), (8.0 + 8.0 + 200.0 + 200.0) / 4.0);
    EXPECT_DOUBLE_EQ(penalised_average_ms(runs[1], kLimit_ms, 10.0), (2.0 + 3000.0) / 4.0);
    // (3 * 101 * 101 * 101)^(1/4) - 1
    EXPECT_NEAR(shifted_geometric_mean(penalised_times_ms(runs[1], kLimit_ms), 1.0), 40.92966, 1e-5);
    EXPECT_THROW((void)penalised_average_ms({}, kLimit_ms, 2.0), InvalidInput);
}

TEST(SolverMeasures, ProfilesCountWithinAMultipleOfTheFastest) {
    const std::vector<double> ratios{1.0, 3.9, 4.0, 8.0, 1000.0};
    const auto profiles = performance_profiles(three_solvers(), ratios);
    EXPECT_THAT(profiles[0],
                ElementsAre(0.25, 0.25, 0.5, 0.5, 0.5));  // wins the second, 4 times in the first
    EXPECT_THAT(profiles[1], ElementsAre(0.25, 0.25, 0.25, 0.25, 0.25));
    EXPECT_THAT(profiles[2], ElementsAre(0.25, 0.25, 0.5, 0.75, 0.75));  // wins the last; 4 and 8 times
    EXPECT_THROW((void)performance_profiles({}, ratios), InvalidInput);
}

TEST(SolverMeasures, SingleAndVirtualBest) {
    const BestSolvers best = best_solvers(three_solvers(), kLimit_ms);
    EXPECT_EQ(best.single_best, 2U);
    EXPECT_DOUBLE_EQ(best.single_par10_ms, (16.0 + 32.0 + 1000.0 + 64.0) / 4.0);
    EXPECT_DOUBLE_EQ(best.virtual_par10_ms, (2.0 + 8.0 + 1000.0 + 64.0) / 4.0);
    EXPECT_THAT(best.won, ElementsAre(1U, 1U, 1U));
    EXPECT_THROW((void)best_solvers({}, kLimit_ms), InvalidInput);
}

TEST(SolverMeasures, DistancesAreBetweenZeroAndOne) {
    EXPECT_DOUBLE_EQ(relative_distance(-3.0, -4.0), 0.25);
    EXPECT_DOUBLE_EQ(relative_distance(-4.0, -3.0), 0.25);
    EXPECT_DOUBLE_EQ(relative_distance(0.0, 0.0), 0.0);
    EXPECT_DOUBLE_EQ(relative_distance(0.0, -2.0), 1.0);
    EXPECT_DOUBLE_EQ(relative_distance(-1.0, 2.0), 1.0);
    EXPECT_DOUBLE_EQ(relative_distance({}, 2.0), 1.0);
}

/// Nothing for 10 ms, then half as good, then the optimum; the bound starts at 2.5 times, is closed at 60 ms.
TEST(SolverMeasures, IntegralsAreAreasBelowTheGap) {
    const std::vector<Knowledge> steps{
        {10.0, -2.0, -10.0}, {30.0, -4.0, {}}, {60.0, -4.0, -4.0}, {120.0, -4.0, -4.0}};
    const GapIntegrals integrals = gap_integrals(steps, -4.0, kLimit_ms);
    EXPECT_DOUBLE_EQ(integrals.primal_ms, 10.0 + 0.5 * 20.0);
    EXPECT_DOUBLE_EQ(integrals.dual_ms, 10.0 + 0.6 * 50.0);
    EXPECT_DOUBLE_EQ(gap_integrals({}, -4.0, kLimit_ms).primal_ms, kLimit_ms);
    EXPECT_DOUBLE_EQ(gap_integrals(steps, -4.0, 20.0).primal_ms, 10.0 + 0.5 * 10.0);
}

TEST(SolverMeasures, VariabilityIsSpreadOverMean) {
    const Variability spread = variability_of(std::vector<double>{2.0, 4.0, 6.0});
    EXPECT_DOUBLE_EQ(spread.coefficient, 0.5);
    EXPECT_DOUBLE_EQ(spread.ratio, 3.0);
    EXPECT_THROW((void)variability_of(std::vector<double>{1.0}), InvalidInput);
}

/// scipy 1.10.1, stats.wilcoxon: the depression scores of Hollander and Wolfe.
TEST(Wilcoxon, ExactWithoutTies) {
    const std::vector<double> before{1.83, 0.50, 1.62, 2.48, 1.68, 1.88, 1.55, 3.06, 1.30};
    const std::vector<double> after{0.878, 0.647, 0.598, 2.05, 1.06, 1.29, 1.06, 3.14, 1.29};
    const SignedRankTest test = signed_rank_test(before, after);
    EXPECT_TRUE(test.is_exact);
    EXPECT_EQ(test.pairs, 9U);
    EXPECT_DOUBLE_EQ(test.rank_sum, 5.0);
    EXPECT_NEAR(test.p_value, 0.0390625, 1e-12);
    EXPECT_NEAR(signed_rank_test(after, before).p_value, 0.0390625, 1e-12);
}

/// By scipy with mode="approx": ties, and two pairs that are equal.
TEST(Wilcoxon, NormalWithTies) {
    const std::vector<double> first{12, 15, 9, 20, 11, 8, 14, 13, 7, 16, 10, 18};
    const std::vector<double> second{10, 15, 11, 16, 9, 9, 12, 15, 5, 13, 10, 15};
    const SignedRankTest test = signed_rank_test(first, second);
    EXPECT_FALSE(test.is_exact);
    EXPECT_EQ(test.pairs, 10U);
    EXPECT_DOUBLE_EQ(test.rank_sum, 10.0);
    EXPECT_NEAR(test.p_value, 0.0677020054450176, 1e-12);
}

/// By scipy: 50 pairs exactly, 60 by the normal approximation.
TEST(Wilcoxon, LargeSamples) {
    std::vector<double> first, second;
    for (int k = 0; k < 60; ++k) {
        first.push_back(k * 37 % 101 / 10.0 + 0.013 * k);
        second.push_back(k * 53 % 97 / 10.0);
    }
    const SignedRankTest sixty = signed_rank_test(first, second);
    EXPECT_FALSE(sixty.is_exact);
    EXPECT_DOUBLE_EQ(sixty.rank_sum, 701.0);
    EXPECT_NEAR(sixty.p_value, 0.16488518664451635, 1e-12);
    // The first pair is equal.
    EXPECT_FALSE(signed_rank_test(std::span(first).first(40), std::span(second).first(40)).is_exact);
    const SignedRankTest fifty =
        signed_rank_test(std::span(first).subspan(1, 50), std::span(second).subspan(1, 50));
    EXPECT_TRUE(fifty.is_exact);
    EXPECT_DOUBLE_EQ(fifty.rank_sum, 493.0);
    EXPECT_NEAR(fifty.p_value, 0.16588679879439283, 1e-12);
}

TEST(Wilcoxon, NothingDiffers) {
    const std::vector<double> same{1.0, 2.0};
    EXPECT_EQ(signed_rank_test(same, same).p_value, 1.0);
    EXPECT_EQ(signed_rank_test(same, same).pairs, 0U);
    EXPECT_THROW((void)signed_rank_test(same, std::vector<double>{1.0}), InvalidInput);
    const std::vector<double> endless{std::numeric_limits<double>::infinity(), 1.0};
    EXPECT_THROW((void)signed_rank_test(same, endless), InvalidInput);
}

/// The p-values times 3, 2 and 1, made non-decreasing.
TEST(Wilcoxon, HolmStepsDown) {
    EXPECT_THAT(holm_corrected(std::vector<double>{0.01, 0.04, 0.03}),
                ElementsAre(DoubleNear(0.03, 1e-15), DoubleNear(0.06, 1e-15), DoubleNear(0.06, 1e-15)));
    EXPECT_THAT(holm_corrected(std::vector<double>{0.9, 0.8}), ElementsAre(DoubleEq(1.0), DoubleEq(1.0)));
}

}  // namespace
}  // namespace conelane
