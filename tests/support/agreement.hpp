#pragma once

#include "conelane/check.hpp"
#include "conelane/solve_report.hpp"
#include "tests/support/testing.hpp"

namespace conelane::tests {

/// The report has the status and the objective of the expected one. Whether it has a lane graph.
inline bool agrees(const RldReport& report, const RldReport& expected, double tolerance = 1e-6) {
    EXPECT_EQ(report.status, expected.status) << report.message;
    EXPECT_EQ(report.objective.has_value(), expected.objective.has_value());
    if (!report.objective || !expected.objective) return false;
    EXPECT_NEAR(*report.objective, *expected.objective, tolerance);
    return true;
}

/// The checker confirms the lane graph of the report, its objective and its bound.
inline void expect_confirmed(const RldReport& report, const Scene& scene, const RldParameters& parameters) {
    ASSERT_TRUE(report.lane_graph) << report.message;
    EXPECT_THAT(
        check(scene, parameters, *report.lane_graph, {true, *report.objective, report.bound}).violations,
        testing::IsEmpty());
}

/// The checker computes the cost of each edge of the problem, for each edge alone.
inline void expect_edge_costs_confirmed(const LaneGraphProblem& problem, const Scene& scene,
                                        const RldParameters& parameters) {
    for (const ProblemEdge& edge : problem.edges) {
        const CheckReport report = check(scene, parameters, LaneGraph{{{edge.i, edge.j}}});
        ASSERT_TRUE(report.objective);
        EXPECT_EQ(report.is_final, edge.high_cost);
        ASSERT_NEAR(*report.objective, edge.cost, 1e-9);
    }
}

}  // namespace conelane::tests
