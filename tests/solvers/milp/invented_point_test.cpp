// Treatment of a point of CBC that violates rows.

#include "solvers/milp/detail/invented_point.hpp"

#include "tests/support/testing.hpp"

namespace conelane::detail {
namespace {

// One row, between 1 and 2.
constexpr std::array kLower{1.0};
constexpr std::array kUpper{2.0};

MilpReport with_a_point(SolveStatus status) {
    MilpReport report;
    report.status = status;
    report.point = {1.0, 0.0};
    report.bound = -3.0;
    report.nodes = 7;
    return report;
}

TEST(InventedPoint, OneThatKeepsItsRowsStays) {
    for (const double activity : {1.0, 1.5, 2.0, 2.0 + 0.5 * kRowTolerance, 1.0 - 0.5 * kRowTolerance}) {
        for (const bool is_time_up : {false, true}) {
            MilpReport report = with_a_point(SolveStatus::optimal);
            EXPECT_EQ(drop_invented_point({{&activity, 1}, kLower, kUpper}, is_time_up, report),
                      PointVerdict::kept);
            EXPECT_EQ(report.status, SolveStatus::optimal);
            EXPECT_EQ(report.point.size(), 2U);
            EXPECT_EQ(report.bound, -3.0);
        }
    }
}

TEST(InventedPoint, AtTheLimitItIsDroppedAndTheSearchIsStopped) {
    for (const double activity : {0.5, 2.5, 2.0 + 2.0 * kRowTolerance}) {
        MilpReport report = with_a_point(SolveStatus::feasible);
        EXPECT_EQ(drop_invented_point({{&activity, 1}, kLower, kUpper}, true, report), PointVerdict::dropped);
        EXPECT_EQ(report.status, SolveStatus::stopped);
        EXPECT_EQ(report.stopped_by, StopReason::time);
        EXPECT_TRUE(report.point.empty());
        EXPECT_FALSE(report.bound.has_value());
    }
}

TEST(InventedPoint, InTimeTheSearchIsRepeated) {
    const double activity = 0.0;
    MilpReport report = with_a_point(SolveStatus::optimal);
    EXPECT_EQ(drop_invented_point({{&activity, 1}, kLower, kUpper}, false, report),
              PointVerdict::search_anew);
    EXPECT_EQ(report.status, SolveStatus::error);
    EXPECT_TRUE(report.point.empty());
    EXPECT_FALSE(report.bound.has_value());
}

}  // namespace
}  // namespace conelane::detail
