// Errata of the printed RLD paper: each test builds a small instance, applies the row as printed, and shows
// its effect beside that of the corrected row. model/formulation.md lists the errata.

#include "conelane/check.hpp"
#include "model/geometry.hpp"
#include "model/lane_graph_model.hpp"
#include "solvers/milp/milp_solver.hpp"
#include "solvers/registry.hpp"
#include "tests/support/cones_at.hpp"

namespace conelane {
namespace {

using tests::cones_at;

LaneGraphProblem paper_problem(const Scene& scene, const RldParameters& parameters = {}) {
    return make_problem(scene, parameters, EdgeExtent::all_pairs);
}

/// Solves a program without the rows that are added on demand.
MilpReport solve(const BinaryProgram& program) {
    return kCbc.load(program)->solve({});
}

RldReport solve_corrected(const LaneGraphProblem& problem) {
    return find_rld_solver("cbc")->make(Formulation::paper)->solve(problem, {});
}

/// Two straight boundaries, the right one half a spacing behind: no edge exactly faces another.
const Scene kStaggered =
    cones_at({{2.6, 1.5}, {5.8, 1.5}, {9.0, 1.5}, {1.0, -1.5}, {4.2, -1.5}, {7.4, -1.5}});

/// (7) printed: a_ij + a_kl <= 1 if MinDist > d_min. Meant: MinDist < d_min.
TEST(Errata, Equation7AsPrintedForbidsFacingEdges) {
    LaneGraphProblem problem = paper_problem(kStaggered);
    const RldReport corrected = solve_corrected(problem);
    ASSERT_EQ(corrected.status, SolveStatus::optimal);
    EXPECT_NEAR(*corrected.objective, -4.0, 1e-9);

    problem.conflicts.clear();
    for (std::size_t e = 0; e < problem.edges.size(); ++e) {
        for (std::size_t f = e + 1; f < problem.edges.size(); ++f) {
            const ProblemEdge& a = problem.edges[e];
            const ProblemEdge& b = problem.edges[f];
            if (a.i == b.i || a.i == b.j || a.j == b.i || a.j == b.j) continue;
            const auto at = [](std::size_t cone) { return kStaggered.cones[cone].position; };
            const SegmentDistance gap = segment_distance({at(a.i), at(a.j)}, {at(b.i), at(b.j)});
            if (gap.distance_m > problem.parameters.d_min && !gap.between_ends)
                problem.conflicts.emplace_back(e, f);
        }
    }
    const RldReport printed = solve_corrected(problem);
    const bool finds_the_lane =
        printed.lane_graph.has_value() && *printed.lane_graph == *corrected.lane_graph;
    EXPECT_FALSE(finds_the_lane);
    EXPECT_TRUE(printed.status == SolveStatus::infeasible || *printed.objective > -4.0 + 1e-6);
}

/// (9) printed: h^T a > 2. Meant: >= 2, as in (33). The least lane has one near edge on each side.
TEST(Errata, Equation9AsPrintedNeedsAThirdEdge) {
    const Scene scene = cones_at({{4, 1.5}, {7.2, 1.5}, {4, -1.5}, {7.2, -1.5}});
    const LaneGraphProblem problem = paper_problem(scene);
    EXPECT_EQ(solve_corrected(problem).status, SolveStatus::optimal);
    const LaneGraphModel model(problem, Formulation::paper);
    BinaryProgram printed = model.program();
    int changed = 0;
    for (BinaryProgram::RowBounds& row : printed.rows) {
        if (row.label.family != "heading") continue;
        row.lower = 3.0;  // > 2 at integers
        ++changed;
    }
    ASSERT_EQ(changed, 1);
    EXPECT_EQ(solve(printed).status, SolveStatus::infeasible);
}

/// (26) printed: the heading cost has weight w_n, which the objective (29) does not know. Meant: w_p.
TEST(Errata, Equation26HasTheWeightOfTheObjective) {
    const Scene scene = cones_at({{4, 1.5}, {7.2, 2.1}, {4, -1.5}, {7.2, -0.9}});
    const LaneGraph graph{{{0, 1}, {2, 3}}};
    RldParameters none{.w_p = 0.0};
    RldParameters some{.w_p = 7.0};
    const LaneGraphProblem problem = paper_problem(scene, some);
    double heading_cost = 0.0;
    for (const ProblemEdge& edge : problem.edges) {
        if (Edge{edge.i, edge.j} == graph.edges[0] || Edge{edge.i, edge.j} == graph.edges[1])
            heading_cost += edge.heading_cost;
    }
    ASSERT_GT(heading_cost, 0.0);
    EXPECT_NEAR(objective(problem, graph) - objective(paper_problem(scene, none), graph), 7.0 * heading_cost,
                1e-12);
    for (const RldParameterField& field : rld_parameter_fields()) EXPECT_NE(field.key, "w_n");
}

/// A program in which every row of a family has this upper bound.
BinaryProgram with_upper_bound(const BinaryProgram& program, std::string_view family, double upper) {
    BinaryProgram changed = program;
    int count = 0;
    for (BinaryProgram::RowBounds& row : changed.rows) {
        if (row.label.family != family) continue;
        row.upper = upper;
        ++count;
    }
    EXPECT_GT(count, 0) << family;
    return changed;
}

/// (27) printed: s^c o a <= 1, which binds no binary a. Meant: = 0.
TEST(Errata, Equation27AsPrintedBindsNothing) {
    // The left boundary's only continuation, past the near cone, is longer than s_crit allows.
    const Scene scene = cones_at({{4, 1.5}, {9.6, 1.5}, {4, -1.5}, {7.2, -1.5}});
    RldParameters parameters{.w_s = 0.0};
    const LaneGraphProblem problem = paper_problem(scene, parameters);
    EXPECT_EQ(solve_corrected(problem).status, SolveStatus::infeasible);
    const LaneGraphModel model(problem, Formulation::paper);
    const MilpReport printed = solve(with_upper_bound(model.program(), "spacing_limit", 1.0));
    ASSERT_EQ(printed.status, SolveStatus::optimal);
    const CheckReport verdict = check(scene, parameters, model.decode(printed.point));
    EXPECT_THAT(verdict.violations, testing::Contains(HasSubstr("(27)")));
}

/// (28) printed: t^c o f <= 1, which binds no binary f. Meant: = 0.
TEST(Errata, Equation28AsPrintedBindsNothing) {
    // The left boundary bends by 80 degrees at its middle cone.
    const Scene scene = cones_at({{1, 1.5}, {4.2, 1.5}, {4.76, 4.65}, {1, -1.5}, {4.2, -1.5}, {7.4, -1.5}});
    RldParameters parameters{.w_t = 0.0, .w_p = 0.0, .d_max = 8.0};
    const LaneGraphProblem problem = paper_problem(scene, parameters);
    const RldReport corrected = solve_corrected(problem);
    const LaneGraphModel model(problem, Formulation::paper);
    const MilpReport printed = solve(with_upper_bound(model.program(), "angle_limit", 1.0));
    ASSERT_EQ(printed.status, SolveStatus::optimal);
    const CheckReport verdict = check(scene, parameters, model.decode(printed.point));
    EXPECT_THAT(verdict.violations, testing::Contains(HasSubstr("(28)")));
    ASSERT_EQ(corrected.status, SolveStatus::optimal);
    EXPECT_GT(*corrected.objective, *printed.bound + 1e-6);
}

/// (12) printed: m_i - r_i + u_i = 1, said to be 0 at near endpoints. A near inner cone has m_i = 0, r_i = 1,
/// so u_i = 2. Meant: m_i (1 - r_i) + u_i = 1.
TEST(Errata, Equation12AsPrintedForbidsNearInnerCones) {
    const Scene scene = cones_at({{1, 1.5}, {4.2, 1.5}, {7.4, 1.5}, {1, -1.5}, {4.2, -1.5}, {7.4, -1.5}});
    const LaneGraphProblem problem = paper_problem(scene);
    const RldReport corrected = solve_corrected(problem);
    ASSERT_EQ(corrected.status, SolveStatus::optimal);
    EXPECT_NEAR(*corrected.objective, -4.0, 1e-9);

    // near_endpoints and far_mark take m_i in different places, so the printed row is written out: of a near
    // cone, 2 g_i - A_i - 1 + u_i = 1.
    const LaneGraphModel model(problem, Formulation::paper);
    const BinaryProgram& program = model.program();
    std::vector<ProgramRow> printed;
    for (std::size_t cone = 0; cone < problem.cone_count; ++cone) {
        if (!problem.near[cone]) continue;
        ProgramRow row{{"far_mark_printed", {static_cast<std::int32_t>(cone)}}, {}, 2.0, 2.0};
        for (std::size_t c = 0; c < program.columns.size(); ++c) {
            const Label& label = program.columns[c].label;
            const auto is_cone = [&](std::int32_t index) { return index == static_cast<std::int32_t>(cone); };
            if (label.family == "a" && (is_cone(label.index.first) || is_cone(label.index.second)))
                row.terms.emplace_back(static_cast<int>(c), -1.0);
            if (label.family == "g" && is_cone(label.index.first))
                row.terms.emplace_back(static_cast<int>(c), 2.0);
            if (label.family == "u" && is_cone(label.index.first))
                row.terms.emplace_back(static_cast<int>(c), 1.0);
        }
        printed.push_back(row);
    }
    // The corrected row of a near cone is u_i = 1; the printed one takes its place.
    BinaryProgram without = program;
    for (BinaryProgram::RowBounds& row : without.rows) {
        if (row.label.family != "far_mark" || !problem.near[static_cast<std::size_t>(row.label.index.first)])
            continue;
        row.lower = -kInfinity;
        row.upper = kInfinity;
    }
    ASSERT_EQ(solve(without).status, SolveStatus::optimal);
    const auto session = kCbc.load(without);
    session->add_rows(printed);
    EXPECT_EQ(session->solve({}).status, SolveStatus::infeasible);
}

/// Page 3: "the resulting graph has exactly two disjoint paths". (1)-(4) allow cycles beside the paths, and
/// dropping them after the solve, as the paper does, is no longer optimal: here the cycle holds cones that
/// the boundaries go on through.
TEST(Errata, Rows1To4AllowCyclesAndDroppingThemIsNotOptimal) {
    RldParameters parameters{.theta_t = 2.0};
    parameters.t_crit = 0.4;  // a turn of a little more than 90 degrees
    parameters.s_crit = 0.01;
    parameters.d_min = 0.0;
    parameters.w_p = 0.0;
    parameters.d_max = 6.0;
    // The left boundary goes on through the lower side of a square, which is tilted by 0.2 rad, so that the
    // boundary can go straight on but not up; the upper side is too far from the right boundary for an end.
    const double along = 3.2 * std::cos(0.2);
    const double up = 3.2 * std::sin(0.2);
    const Scene scene = cones_at({{4.0, 1.5},
                                  {7.2, 1.5},
                                  {10.4, 1.5},
                                  {10.4 + along, 1.5 + up},
                                  {10.4 + along - up, 1.5 + up + along},
                                  {10.4 - up, 1.5 + along},
                                  {4.0, -2.5},
                                  {7.2, -2.5},
                                  {10.4, -2.5}});
    const LaneGraphProblem problem = paper_problem(scene, parameters);
    const RldReport exact = solve_corrected(problem);
    ASSERT_EQ(exact.status, SolveStatus::optimal);

    const LaneGraphModel model(problem, Formulation::paper);
    const MilpReport printed = solve(model.program());
    ASSERT_EQ(printed.status, SolveStatus::optimal);
    EXPECT_LT(*printed.bound, *exact.objective - 1e-6);
    LaneGraph graph = model.decode(printed.point);
    ASSERT_FALSE(paths(graph, scene.cones.size()).has_value()) << "there is no cycle";

    // Drop the cycle: the edges between cones that lead to no endpoint.
    std::vector<std::vector<std::size_t>> others(scene.cones.size());
    for (const Edge& edge : graph.edges) {
        others[edge.i].push_back(edge.j);
        others[edge.j].push_back(edge.i);
    }
    std::vector<bool> on_path(scene.cones.size(), false);
    for (std::size_t cone = 0; cone < others.size(); ++cone) on_path[cone] = others[cone].size() == 1;
    for (std::size_t pass = 0; pass < others.size(); ++pass) {
        for (std::size_t cone = 0; cone < others.size(); ++cone) {
            for (const std::size_t other : others[cone]) on_path[cone] = on_path[cone] || on_path[other];
        }
    }
    std::erase_if(graph.edges, [&](const Edge& edge) { return !on_path[edge.i]; });
    EXPECT_THAT(check(scene, parameters, graph).violations, testing::IsEmpty());
    EXPECT_GT(objective(problem, graph), *exact.objective + 1e-6);
}

}  // namespace
}  // namespace conelane
