#include "evaluation/scoring/statistics.hpp"

#include "conelane/invalid_input.hpp"
#include "tests/support/testing.hpp"

#include <numeric>

namespace conelane {
namespace {

TEST(Median, IsTheMiddleOrTheMeanOfTheMiddleTwo) {
    EXPECT_DOUBLE_EQ(median(std::vector<double>{7}), 7.0);
    EXPECT_DOUBLE_EQ(median(std::vector<double>{9, 1, 4}), 4.0);
    EXPECT_DOUBLE_EQ(median(std::vector<double>{9, 1, 4, 6}), 5.0);
}

TEST(Quantile, IsOfNearestRank) {
    std::vector<double> twenty(20);
    std::iota(twenty.rbegin(), twenty.rend(), 1.0);
    EXPECT_DOUBLE_EQ(quantile(twenty, 0.95), 19.0) << "19 of 20 values are at most 19";
    EXPECT_DOUBLE_EQ(quantile(twenty, 0.951), 20.0);
    EXPECT_DOUBLE_EQ(quantile(twenty, 0.99), 20.0);
    EXPECT_DOUBLE_EQ(quantile(twenty, 0.0), 1.0);
    EXPECT_DOUBLE_EQ(quantile(twenty, 1.0), 20.0);
    EXPECT_DOUBLE_EQ(quantile(std::vector<double>{3}, 0.5), 3.0);
}

TEST(Quantile, OfWholeRanksIsNotLiftedByRounding) {
    // 0.07 * 100 is above 7 in floating point.
    std::vector<double> hundred(100);
    std::iota(hundred.begin(), hundred.end(), 1.0);
    ASSERT_GT(0.07 * 100, 7.0);
    EXPECT_DOUBLE_EQ(quantile(hundred, 0.07), 7.0);
}

TEST(Spread, IsThatOfASample) {
    EXPECT_DOUBLE_EQ(mean(std::vector<double>{2, 4, 9}), 5.0);
    EXPECT_DOUBLE_EQ(standard_deviation(std::vector<double>{2, 4, 9}), std::sqrt(13.0));
    EXPECT_DOUBLE_EQ(standard_deviation(std::vector<double>{5}), 0.0);
}

TEST(ShiftedGeometricMean, DampsSmallAndLargeValues) {
    EXPECT_NEAR(shifted_geometric_mean(std::vector<double>{0, 3}, 1.0), 1.0, 1e-12);  // sqrt(1 * 4) - 1
    EXPECT_NEAR(shifted_geometric_mean(std::vector<double>{9, 999}, 1.0), 99.0, 1e-9);
}

TEST(LatencyStatistics, OfFourRuns) {
    const LatencyStatistics latency = latency_statistics(std::vector<double>{50.0, 0.0, 50.1, 3.0});
    EXPECT_DOUBLE_EQ(latency.median_ms, 26.5);
    EXPECT_DOUBLE_EQ(latency.mean_ms, 25.775);
    EXPECT_DOUBLE_EQ(latency.p95_ms, 50.1);
    EXPECT_DOUBLE_EQ(latency.p99_ms, 50.1);
    EXPECT_DOUBLE_EQ(latency.max_ms, 50.1);
    EXPECT_DOUBLE_EQ(latency.share_within_budget, 0.75) << "the budget itself is within";
    EXPECT_NEAR(latency.shifted_geometric_mean_ms, std::pow(51.0 * 1.0 * 51.1 * 4.0, 0.25) - 1.0, 1e-9);
}

TEST(Statistics, OfNothingAreRefused) {
    EXPECT_THROW((void)median({}), InvalidInput);
    EXPECT_THROW((void)quantile({}, 0.5), InvalidInput);
    EXPECT_THROW((void)mean({}), InvalidInput);
    EXPECT_THROW((void)standard_deviation({}), InvalidInput);
    EXPECT_THROW((void)shifted_geometric_mean({}, 1.0), InvalidInput);
    EXPECT_THROW((void)latency_statistics({}), InvalidInput);
}

TEST(Statistics, CoursesAreTheUnitsOfAnInterval) {
    const std::vector<double> values{1.0, 1.0, 1.0, 5.0};
    const CourseMean two = course_mean(values, std::vector<std::string>{"b", "b", "b", "a"});
    EXPECT_DOUBLE_EQ(two.mean, 2.0);
    EXPECT_EQ(two.of_course, (std::vector<double>{5.0, 1.0}));
    // A quarter of the draws has one course alone.
    EXPECT_EQ(two.interval, std::pair(1.0, 5.0));
    EXPECT_FALSE(course_mean(values, std::vector<std::string>(4, "a")).interval);
    EXPECT_THROW((void)course_mean(values, std::vector<std::string>(3, "a")), InvalidInput);
    std::vector<std::string> courses;
    std::vector<double> many;
    for (int k = 0; k < 60; ++k) {
        courses.push_back(std::to_string(k / 2));
        many.push_back(k / 2 % 2);
    }
    const CourseMean half = course_mean(many, courses);
    // 30 courses of 0 and 1: the standard error of their mean is 0.5 / sqrt(30).
    EXPECT_NEAR(half.interval->second - half.interval->first, 2.0 * 1.96 * 0.5 / std::sqrt(30.0), 0.04);
    EXPECT_EQ(half.interval, course_mean(many, courses).interval);
    for (double& value : many) value += std::sqrt(static_cast<double>(&value - many.data()));
    EXPECT_NE(course_mean(many, courses).interval, course_mean(many, courses, 2).interval);
}

}  // namespace
}  // namespace conelane
