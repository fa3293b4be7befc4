// The program of a problem: an update equals a new program; lane graphs are carried from scene to scene.

#include "model/lane_graph_model.hpp"

#include "conelane/check.hpp"
#include "model/answer_verification.hpp"
#include "tests/support/random_scenes.hpp"

namespace conelane {
namespace {

/// The whole program as text, so that any difference shows.
std::string text_of(const BinaryProgram& program) {
    std::string text;
    for (const BinaryProgram::Column& column : program.columns) {
        text += to_string(column.label) + " " + std::to_string(column.objective) + " " +
                std::to_string(column.lower) + " " + std::to_string(column.upper) +
                (column.integer ? " integer\n" : "\n");
    }
    for (std::size_t r = 0; r < program.rows.size(); ++r) {
        text += to_string(program.rows[r].label) + " " + std::to_string(program.rows[r].lower) + " " +
                std::to_string(program.rows[r].upper) + ":";
        for (int e = program.row_starts[r]; e < program.row_starts[r + 1]; ++e) {
            text += " " + std::to_string(program.entry_values[static_cast<std::size_t>(e)]) + "*" +
                    std::to_string(program.entry_columns[static_cast<std::size_t>(e)]);
        }
        text += "\n";
    }
    return text;
}

class ModelUpdate : public testing::TestWithParam<Formulation> {};

/// Sizes repeat and change, so that both ways of updating are taken.
TEST_P(ModelUpdate, EqualsANewProgram) {
    const EdgeExtent extent = parts(GetParam()).extent;
    const RldParameters parameters;
    const LaneGraphProblem first = make_problem(tests::random_scene(0, 8), parameters, extent);
    LaneGraphModel model(first, GetParam());
    for (std::uint64_t seed = 1; seed < 60; ++seed) {
        const Scene scene = tests::random_scene(seed, 6 + (seed / 3) % 4);
        const LaneGraphProblem problem = make_problem(scene, parameters, extent);
        model.update(problem);
        ASSERT_EQ(text_of(model.program()), text_of(LaneGraphModel(problem, GetParam()).program()))
            << "seed " << seed;
    }
}

INSTANTIATE_TEST_SUITE_P(Formulations, ModelUpdate, testing::Values(Formulation::tight, Formulation::paper),
                         [](const auto& test) { return std::string(to_string(test.param)); });

TEST(FailedExpectations, PrintWhatTheyCompare) {
    EXPECT_EQ(testing::PrintToString(std::optional(LaneGraph{{{0, 1}, {1, 2}}})), "(edges 0-1 1-2)");
    EXPECT_EQ(testing::PrintToString(Lane{{1, 2}, {-3}, true}), "closed, left 1 2, right -3");
    EXPECT_EQ(testing::PrintToString(LaneStatus::stopped), "stopped");
    EXPECT_EQ(testing::PrintToString(MergedCone{4, 7}), "4 into 7");
}

TEST(MapByConeId, FindsConesAgainAndDropsMissingOnes) {
    Scene before;
    before.cones = {{7, {0, 0}}, {3, {3, 0}}, {9, {6, 0}}};
    Scene after;
    after.cones = {{9, {6, 0}}, {1, {9, 0}}, {3, {3, 0}}};
    const LaneGraph graph{{{0, 1}, {1, 2}}};
    const LaneGraph expected{{{0, 2}}};
    EXPECT_EQ(map_by_cone_id(before, graph, after), expected);
    EXPECT_EQ(map_by_cone_id(before, graph, before), graph);
}

/// Random sets of up to six edges, many of them lanes with one error: the problem's own test, the
/// verification of answers and the checker, which share no code, must agree.
TEST(IsFeasible, AgreesWithTheVerificationAndTheChecker) {
    int feasible = 0;
    for (std::uint64_t seed = 0; seed < 400; ++seed) {
        boost::random::mt19937_64 random(seed);
        const auto below = [&](std::size_t count) {
            return boost::random::uniform_int_distribution<std::size_t>(0, count - 1)(random);
        };
        const Scene scene = tests::random_scene(seed, 8);
        RldParameters parameters{.d_max = 9.0,
                                 .s_crit = 20.0,
                                 .t_crit = 30.0,
                                 .pairing = seed % 2 == 0 ? Pairing::paper : Pairing::near_far};
        const LaneGraphProblem problem = make_problem(scene, parameters);
        for (int trial = 0; trial < 40; ++trial) {
            // Two chains, over cones of even and of odd index, as the lane was made; sometimes a stray edge.
            LaneGraph graph;
            for (const std::size_t side : {0u, 1u}) {
                const std::size_t length = 1 + below(3);
                for (std::size_t k = 0; k < length; ++k)
                    graph.edges.push_back(make_edge(side + 2 * k, side + 2 * k + 2));
            }
            if (below(4) == 0) graph.edges.push_back(make_edge(below(4), 4 + below(4)));
            std::ranges::sort(graph.edges);
            graph.edges.erase(std::unique(graph.edges.begin(), graph.edges.end()), graph.edges.end());
            const bool valid = check(scene, parameters, graph).violations.empty();
            SCOPED_TRACE(testing::Message() << "seed " << seed << ", trial " << trial);
            ASSERT_EQ(is_feasible(problem, graph), valid);
            const VerifiedAnswer answer = verify_answer(problem, graph);
            ASSERT_EQ(answer.violation.empty(), valid) << answer.violation;
            if (!valid) continue;
            ++feasible;
            EXPECT_NEAR(answer.objective, objective(problem, graph), 1e-9);
        }
    }
    EXPECT_GT(feasible, 100);
}

}  // namespace
}  // namespace conelane
