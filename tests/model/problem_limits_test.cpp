// Making a problem, and its program, within a deadline and a limit of memory.

#include "conelane/invalid_input.hpp"
#include "model/lane_graph_model.hpp"
#include "tests/support/processor_time.hpp"
#include "tests/support/random_scenes.hpp"

namespace conelane {
namespace {

RldParameters with_all_costs() {
    return RldParameters{.unevenness_weight = 0.3, .facing_weight = 0.8, .near_end_weight = 0.9};
}

TEST(ProblemLimits, ADeadlineThatDoesNotPassChangesNothing) {
    for (const EdgeExtent extent : {EdgeExtent::candidates, EdgeExtent::all_pairs}) {
        const Scene scene = tests::random_scene(3, 20);
        const LaneGraphProblem plain = make_problem(scene, with_all_costs(), extent);
        const LimitedProblem limited = make_problem(scene, with_all_costs(), extent, Deadline(1e300));
        ASSERT_TRUE(limited.problem);
        EXPECT_FALSE(limited.stopped_by);
        ASSERT_EQ(limited.problem->edges.size(), plain.edges.size());
        for (std::size_t e = 0; e < plain.edges.size(); ++e)
            EXPECT_EQ(limited.problem->edges[e].cost, plain.edges[e].cost);
        ASSERT_EQ(limited.problem->turns.size(), plain.turns.size());
        for (std::size_t t = 0; t < plain.turns.size(); ++t)
            EXPECT_EQ(limited.problem->turns[t].cost, plain.turns[t].cost);
        EXPECT_EQ(limited.problem->conflicts, plain.conflicts);
        EXPECT_EQ(limited.problem->far_apart, plain.far_apart);
    }
}

TEST(ProblemLimits, ADeadlineThatHasPassedLeavesNoProblem) {
    for (const double limit_ms : {0.0, -1.0}) {
        const LimitedProblem limited =
            make_problem(tests::random_scene(3, 20), {}, EdgeExtent::candidates, Deadline(limit_ms));
        EXPECT_FALSE(limited.problem);
        EXPECT_EQ(limited.stopped_by, StopReason::time);
    }
}

/// Each part takes longer than this: edges, facing costs, turns and conflicts. The whole takes seconds and
/// gigabytes, so the test also shows that it stops.
TEST(ProblemLimits, LargeScenesEndAtTheDeadlineOrAtTheBoundOfMemory) {
    for (const double side_m : {8.0, 30.0, 50.0, 2e6}) {
        for (const std::size_t cones : {800UL, 2000UL, 5000UL}) {
            for (const RldParameters& parameters : {RldParameters{}, with_all_costs()}) {
                for (const double limit_ms : {1.0, 20.0, 200.0}) {
                    SCOPED_TRACE(testing::Message()
                                 << cones << " cones, " << side_m << " m, " << limit_ms << " ms");
                    const Scene scene = tests::strewn_scene(cones, side_m, side_m, cones);
                    LimitedProblem limited;
                    EXPECT_LT(tests::overrun_ms(limit_ms, 1000.0,
                                                [&] {
                                                    limited = make_problem(scene, parameters,
                                                                           EdgeExtent::candidates,
                                                                           Deadline(limit_ms));
                                                }),
                              1000.0);
                    EXPECT_NE(limited.problem.has_value(), limited.stopped_by.has_value());
                    if (limited.problem) {
                        EXPECT_FALSE(is_too_large(*limited.problem));
                    }
                }
            }
        }
    }
}

TEST(ProblemLimits, AreTheNumbersThatStandThere) {
    LaneGraphProblem problem;
    problem.edges.resize(kMaxProblemEdges);
    problem.conflicts.resize(kMaxProblemEntries);
    EXPECT_FALSE(is_too_large(problem));
    problem.edges.emplace_back();
    EXPECT_TRUE(is_too_large(problem));
    problem.edges.pop_back();
    problem.turns.emplace_back();
    EXPECT_TRUE(is_too_large(problem));
}

/// 5000 cones within a few metres: the edges alone would be millions.
TEST(ProblemLimits, StopsByMemoryIfThereIsEnoughTime) {
    const LimitedProblem limited =
        make_problem(tests::strewn_scene(5000, 8.0, 8.0, 5000), {}, EdgeExtent::candidates, Deadline());
    EXPECT_FALSE(limited.problem);
    EXPECT_EQ(limited.stopped_by, StopReason::memory);
    const LimitedProblem pairs =
        make_problem(tests::strewn_scene(5000, 8.0, 8.0, 5000), {}, EdgeExtent::all_pairs, Deadline());
    EXPECT_EQ(pairs.stopped_by, StopReason::memory);
}

TEST(ProblemLimits, InvalidInputIsThrownWhateverTheDeadline) {
    Scene scene = tests::random_scene(3, 6);
    scene.cones[2].position.x() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW((void)make_problem(scene, {}, EdgeExtent::candidates, Deadline(0.0)), InvalidInput);
}

TEST(ProgramLimits, AStoppedUpdateLeavesTheModelFitForTheNext) {
    const auto update_after_a_stop = [](Formulation formulation, std::size_t cones) {
        const EdgeExtent extent = parts(formulation).extent;
        const LaneGraphProblem first = make_problem(tests::random_scene(1, 12), {}, extent);
        const LaneGraphProblem second = make_problem(tests::random_scene(2, cones), {}, extent);
        LaneGraphModel model(formulation);
        EXPECT_FALSE(model.update(first, Deadline()));
        EXPECT_EQ(model.update(second, Deadline(0.0)), StopReason::time);
        EXPECT_FALSE(model.update(second, Deadline()));
        const LaneGraphModel anew(second, formulation);
        EXPECT_EQ(model.program().rows.size(), anew.program().rows.size());
        EXPECT_EQ(model.program().row_starts, anew.program().row_starts);
        EXPECT_EQ(model.program().entry_columns, anew.program().entry_columns);
        EXPECT_EQ(model.program().entry_values, anew.program().entry_values);
    };
    // With other columns the program is built again, then by a model that was stopped while building.
    for (const std::size_t cones : {12, 13}) {
        for (const Formulation formulation : {Formulation::tight, Formulation::paper})
            update_after_a_stop(formulation, cones);
    }
}

}  // namespace
}  // namespace conelane
