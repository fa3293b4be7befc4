// Programs and lane graphs recomputed in rational arithmetic: small ones by hand, solved scenes, forged ones.

#include "conelane/check.hpp"
#include "conelane/solve_scene.hpp"
#include "evaluation/proofs/exact_arithmetic.hpp"
#include "model/lane_graph_model.hpp"
#include "solvers/registry.hpp"
#include "tests/support/program_fixture.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/six_cone_lane.hpp"

namespace conelane {
namespace {

/// Two columns x_0, x_1 and one row: lower <= c_0 x_0 + c_1 x_1 <= upper.
BinaryProgram program_of(double c_0, double c_1, double lower, double upper) {
    BinaryProgram program;
    program.add_column({"x", {0}}, 0.1, true);
    program.add_column({"x", {1}}, 0.2, true);
    RowWriter rows(program);
    rows.begin({"limit"}, lower, upper);
    rows.add(0, c_0);
    rows.add(1, c_1);
    rows.end();
    return program;
}

// 0.1 and 0.2 are the fractions 3602879701896397 / 2^55 and 3602879701896397 / 2^54. Their sum is
// 10808639105689191 / 2^55; the nearest double is 10808639105689192 / 2^55 = 0.30000000000000004.
TEST(ExactProgram, ReadsDoublesAsExactFractions) {
    const ExactProgramReport report =
        recompute_exactly(program_of(0.1, 0.2, 0.0, 0.3), std::vector{1.0, 1.0});
    const Rational unit = Rational(1) / Rational(boost::multiprecision::cpp_int(1) << 55);
    EXPECT_EQ(report.objective, Rational(10808639105689191) * unit);
    EXPECT_EQ(report.objective_rounding, std::ldexp(1.0, -55));
    EXPECT_EQ(report.row_rounding, std::ldexp(1.0, -55));
    // The double 0.3 is 10808639105689190 / 2^55.
    EXPECT_EQ(report.violation, std::ldexp(1.0, -55));
    EXPECT_EQ(report.violated, "limit");
    EXPECT_EQ(exact_difference(report.objective, 0.3), std::ldexp(1.0, -55));
}

TEST(ExactProgram, SeesWhatDoublesRoundAway) {
    const BinaryProgram program = program_of(1e16, 1.0, -kInfinity, 1e16);
    EXPECT_EQ(1e16 + 1.0, 1e16) << "in double the row holds";
    const ExactProgramReport both = recompute_exactly(program, std::vector{1.0, 1.0});
    EXPECT_EQ(both.violation, 1.0);
    EXPECT_EQ(both.row_rounding, 1.0);
    const ExactProgramReport one = recompute_exactly(program, std::vector{1.0, 0.0});
    EXPECT_EQ(one.violation, 0.0);
    EXPECT_EQ(one.violated, "");
}

TEST(ExactProgram, ColumnsHaveBoundsToo) {
    const BinaryProgram program = program_of(1.0, 1.0, -kInfinity, kInfinity);
    const ExactProgramReport above = recompute_exactly(program, std::vector{0.0, 1.0 + 1e-12});
    EXPECT_NEAR(above.violation, 1e-12, 1e-15);
    EXPECT_EQ(above.violated, "x_1");
    EXPECT_EQ(recompute_exactly(program, std::vector{-0.5, 0.0}).violation, 0.5);
}

TEST(ExactProgram, AColumnWithoutMeaningIsRefused) {
    EXPECT_THROW((void)point_of(program_of(1.0, 1.0, 0.0, 1.0), {}, {}), std::invalid_argument);
}

/// The optimum of a scene, which must have one.
struct Solved {
    Scene scene;
    RldParameters parameters;
    LaneGraph graph;
    double objective;
};
std::vector<Solved> solved_scenes(bool shape_costs) {
    std::vector<Solved> all;
    const auto solver = find_rld_solver("path-pair")->make(Formulation::tight);
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        Solved solved{
            tests::random_scene(seed, 10), shape_costs ? with_shape_costs({}) : RldParameters{}, {}, 0.0};
        if (seed % 3 == 0) solved.parameters.pairing = Pairing::paper;
        const RldReport report = solve_scene(*solver, solved.scene, solved.parameters, {}).report;
        if (!report.lane_graph) continue;
        solved.graph = *report.lane_graph;
        solved.objective = *report.objective;
        all.push_back(solved);
    }
    return all;
}

// The exact objective of the program at the solver's answer equals the solver's objective and the one that
// the checker computes from the scene in extended precision. Every row holds within the tolerance of the
// limits.
TEST(ExactLaneGraph, AnswersAreFeasibleAndHaveTheStatedCost) {
    for (const bool shape_costs : {false, true}) {
        const std::vector<Solved> all = solved_scenes(shape_costs);
        ASSERT_GT(all.size(), 10U);
        for (const Solved& solved : all) {
            SCOPED_TRACE(solved.scene.id);
            for (const Formulation formulation : {Formulation::tight, Formulation::paper}) {
                const auto exact =
                    recompute_exactly(solved.scene, solved.parameters, formulation, solved.graph);
                ASSERT_TRUE(exact);
                EXPECT_LE(exact->violation, 1e-9) << exact->violated;
                EXPECT_LE(exact_difference(exact->objective, solved.objective), 1e-12);
                const CheckReport checked = check(solved.scene, solved.parameters, solved.graph);
                EXPECT_LE(exact_difference(exact->objective, checked.objective.value()), 1e-10);
                EXPECT_LE(exact->row_rounding, 1e-12);
                EXPECT_GT(exact->rows, 10U);
            }
        }
    }
}

/// With one edge fewer or one edge more, a lane graph violates rows of either formulation.
TEST(ExactLaneGraph, ForgeriesViolateARow) {
    std::vector<Solved> some = solved_scenes(false);
    some.resize(8);
    for (const Solved& solved : some) {
        SCOPED_TRACE(solved.scene.id);
        const LaneGraphProblem problem = make_problem(solved.scene, solved.parameters);
        std::vector<LaneGraph> forged;
        for (const ProblemEdge& edge : problem.edges) {
            LaneGraph other = solved.graph;
            const auto place = std::ranges::find(other.edges, Edge{edge.i, edge.j});
            if (place != other.edges.end()) {
                other.edges.erase(place);
            } else {
                other.edges.push_back({edge.i, edge.j});
                std::ranges::sort(other.edges);
            }
            if (!is_feasible(problem, other)) forged.push_back(std::move(other));
        }
        ASSERT_FALSE(forged.empty());
        for (const LaneGraph& graph : forged) {
            for (const Formulation formulation : {Formulation::tight, Formulation::paper}) {
                const auto exact = recompute_exactly(solved.scene, solved.parameters, formulation, graph);
                EXPECT_GT(exact->violation, 1e-9) << to_string(formulation);
                EXPECT_FALSE(exact->violated.empty());
            }
        }
    }
}

/// A pair of boundaries and a circle of cones beside it, which only rows on demand forbid.
TEST(ExactLaneGraph, ACycleViolatesTheRowsOnDemand) {
    Scene scene = tests::six_cone_lane();
    for (const auto& [x, y] : {std::pair{2.0, 12.0}, {5.2, 12.0}, {5.2, 15.2}, {2.0, 15.2}})
        scene.cones.push_back({static_cast<ConeId>(scene.cones.size()), {x, y}});
    RldParameters parameters;
    parameters.theta_t = 1.5;  // allows right angles
    const LaneGraph lane{{{0, 1}, {1, 2}, {3, 4}, {4, 5}}};
    EXPECT_EQ(recompute_exactly(scene, parameters, Formulation::tight, lane)->violation, 0.0);
    LaneGraph with_cycle = lane;
    for (const Edge& edge : {Edge{6, 7}, Edge{6, 9}, Edge{7, 8}, Edge{8, 9}})
        with_cycle.edges.push_back(edge);
    const auto exact = recompute_exactly(scene, parameters, Formulation::tight, with_cycle);
    EXPECT_EQ(exact->violation, 1.0);
    EXPECT_THAT(exact->violated, StartsWith("acyclic"));
}

TEST(ExactLaneGraph, AnEdgeThatTheProgramDoesNotHaveIsRefused) {
    const Solved solved = solved_scenes(false).front();
    const LaneGraphProblem problem = make_problem(solved.scene, solved.parameters);
    for (std::size_t j = 1; j < solved.scene.cones.size(); ++j) {
        const Edge edge{0, j};
        if (std::ranges::any_of(problem.edges, [&](const ProblemEdge& e) { return e.i == 0 && e.j == j; }))
            continue;
        LaneGraph graph = solved.graph;
        graph.edges.insert(graph.edges.begin(), edge);
        EXPECT_THROW((void)recompute_exactly(solved.scene, solved.parameters, Formulation::tight, graph),
                     std::invalid_argument);
        return;
    }
    FAIL() << "every pair is an edge";
}

using CheckExactly = ProgramFixture;

// An objective whose error is below the checker's tolerance, but above the rounding of doubles.
TEST_F(CheckExactly, TheCommandFindsErrorsBelowTheCheckersTolerance) {
    run_well("scenes --tracks generated:kidney --every 60 --out s.scenes.jsonl");
    run_well("solve --nearest 12 --scenes s.scenes.jsonl --out s.solutions.jsonl");
    const std::string check = "check --scenes s.scenes.jsonl --solutions ";
    const Outcome honest = run(check + "s.solutions.jsonl --exact");
    EXPECT_EQ(honest.exit_code, 0) << honest.output;
    EXPECT_THAT(honest.output, testing::HasSubstr("4 lane graphs in rational arithmetic"));
    EXPECT_THAT(honest.output, testing::HasSubstr("4 passed, 0 failed"));

    std::string forged = text_of(path("s.solutions.jsonl"));
    const std::string key = "\"objective\":";
    const std::size_t value = forged.find(key) + key.size();
    const std::size_t end = forged.find(',', value);
    const double objective = std::stod(forged.substr(value, end - value));
    forged.replace(value, end - value, std::to_string(std::round(objective * 1e6) / 1e6));
    file_with(forged, "forged.solutions.jsonl");
    run_well(check + "forged.solutions.jsonl");
    const Outcome forgery = run(check + "forged.solutions.jsonl --exact");
    EXPECT_EQ(forgery.exit_code, 1);
    EXPECT_THAT(forgery.output, testing::HasSubstr("in rational arithmetic the objective is"));
    EXPECT_THAT(forgery.output, testing::HasSubstr("3 passed, 1 failed"));
}

}  // namespace
}  // namespace conelane
