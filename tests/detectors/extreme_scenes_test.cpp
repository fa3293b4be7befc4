// Scenes and parameters at the limits of double: every solver answers, and none ends the program.

#include "conelane/check.hpp"
#include "conelane/solve_scene.hpp"
#include "model/lane_graph_model.hpp"
#include "solvers/registry.hpp"
#include "tests/support/cones_at.hpp"
#include "tests/support/random_scenes.hpp"

namespace conelane {
namespace {

constexpr double kLimit_ms = 10'000.0;

/// Two straight boundaries of three cones, 3.25 m apart along them and 3.5 m across. The optimum contains all
/// of them. Every number is a multiple of 1/4, so that a shift by a large whole number is exact.
Scene straight_lane(const Point& at) {
    Scene scene;
    scene.pose.position = at;
    for (const double y : {1.75, -1.75}) {
        for (const double x : {1.0, 4.25, 7.5})
            scene.cones.push_back({static_cast<ConeId>(scene.cones.size()), at + Point(x, y)});
    }
    return scene;
}

TEST(ExtremeScenes, FarFromTheOriginNothingChanges) {
    const LaneGraphProblem here = make_problem(straight_lane({0.0, 0.0}), {}, EdgeExtent::all_pairs);
    for (const double away : {1e5, 1e6, 1e9, 1e12, 1e15}) {
        const LaneGraphProblem there =
            make_problem(straight_lane({away, -2.0 * away}), {}, EdgeExtent::all_pairs);
        ASSERT_EQ(there.edges.size(), here.edges.size());
        for (std::size_t e = 0; e < here.edges.size(); ++e)
            EXPECT_NEAR(there.edges[e].cost, here.edges[e].cost, 1e-9 * std::abs(here.edges[e].cost)) << away;
        EXPECT_EQ(there.conflicts, here.conflicts);
        EXPECT_EQ(there.far_apart, here.far_apart);
        EXPECT_EQ(there.near, here.near);
    }
}

/// A column that rows fix at 0 costs at most 1e9, and all numbers of the program are finite.
TEST(ExtremeScenes, ProgramsHoldNumbersThatSolversCanTake) {
    for (const double factor : {1.0, 1e3, 1e9, 1e160, 1e300}) {
        Scene scene = tests::random_scene(3, 7);
        for (Cone& cone : scene.cones) cone.position *= factor;
        const LaneGraphProblem problem = make_problem(scene, {}, EdgeExtent::all_pairs);
        const LaneGraphModel model(problem, Formulation::paper);
        for (const BinaryProgram::Column& column : model.program().columns)
            EXPECT_LE(std::abs(column.objective), 1e9) << to_string(column.label) << " at " << factor;
        for (const double value : model.program().entry_values)
            EXPECT_LE(std::abs(value), 2e6) << factor;  // m_i = 2 g_i - A_i
    }
}

TEST(ExtremeScenes, EverySolverAnswersAtEveryScale) {
    for (const RldSolverEntry& entry : rld_solvers()) {
        for (const Formulation formulation : {Formulation::tight, Formulation::paper}) {
            for (const double factor : {1e-300, 1e-160, 1e-6, 1e6, 1e160, 1e300}) {
                Scene scene = tests::random_scene(3, 7);
                for (Cone& cone : scene.cones) cone.position *= factor;
                const RldReport report =
                    solve_scene(*entry.make(formulation), scene, {}, {.limits = {kLimit_ms}}).report;
                EXPECT_NE(report.status, SolveStatus::error) << entry.name << ": " << report.message;
                EXPECT_FALSE(report.lane_graph) << entry.name << " at " << factor;
            }
        }
    }
}

/// Cones 10^-160 m apart, with that spacing expected: problem and checker agree that an edge cannot be so
/// short, and which longer edges are allowed.
TEST(ExtremeScenes, EdgesAreAtLeast1em100Long) {
    for (const double spacing : {1e-160, 0.9e-100, 1.1e-100, 1e-9}) {
        Scene scene;
        scene.cones = {{1, {0.0, 0.0}}, {2, {spacing, 0.0}}};
        RldParameters parameters{.d_e = spacing};
        const bool allowed = spacing > 1e-100;
        EXPECT_EQ(make_problem(scene, parameters).edges.empty(), !allowed) << spacing;
        EXPECT_EQ(make_problem(scene, parameters, EdgeExtent::all_pairs).edges.at(0).high_cost, !allowed);
        const CheckReport checked = check(scene, parameters, LaneGraph{{{0, 1}}});
        EXPECT_EQ(std::ranges::count(checked.violations, "edge {1, 2} has no length"), allowed ? 0 : 1);
    }
}

/// The report of each exact solver, by its name.
std::map<std::string, RldReport> exact_reports(const Scene& scene, const RldParameters& parameters) {
    std::map<std::string, RldReport> reports;
    for (const RldSolverEntry& entry : rld_solvers()) {
        if (!entry.has(SolverTrait::exact)) continue;
        reports[std::string(entry.name)] =
            solve_scene(*entry.make(Formulation::tight), scene, parameters, {.limits = {kLimit_ms}}).report;
    }
    return reports;
}

/// Found by cross-check: for this infeasible program, CBC's preprocessing returns a point.
TEST(ExtremeScenes, AnInventedPointOfCbcIsNoAnswer) {
    Scene scene;
    scene.pose.yaw_rad = 2.281;
    scene.cones = {{8, {5.8825, 4.6447}}, {1, {-1.9522, 1.3658}}, {0, {-2.0448, 6.9194}},
                   {4, {7.1187, 2.5888}}, {3, {-3.6651, 0.7825}}, {5, {3.2839, 4.6543}},
                   {2, {-4.04, 5.0428}}};
    RldParameters parameters{.pairing = Pairing::paper};
    for (const auto& [name, report] : exact_reports(scene, parameters))
        EXPECT_EQ(report.status, SolveStatus::infeasible) << name << ": " << report.message;
}

/// Found by cross-check. Two boundaries a kilometre apart, cones 2 km apart along them, spacings of 1 km
/// expected:
///     0 ----- 1 ----- 2
///   car >
///     3 ----- 4 ----- 5
/// The midpoint of 0 and 3 is the car's place, so the edge between them costs 1.9e13. Beside it a rounding
/// error of 1e-13 weighs as much as a lane: GLPK took the lane of two edges for the best. Each of the four
/// costs 0.4 - 1.
TEST(ExtremeScenes, AHugeCostHidesNoBetterLane) {
    Scene scene =
        tests::cones_at({{2000, 500}, {2000, -500}, {0, -500}, {0, 500}, {4000, 500}, {4000, -500}});
    RldParameters parameters;
    parameters.d_e = parameters.d_t = parameters.d_h = parameters.d_near = parameters.d_max = 1000.0;
    for (const auto& [name, report] : exact_reports(scene, parameters)) {
        EXPECT_EQ(report.status, SolveStatus::optimal) << name << ": " << report.message;
        EXPECT_NEAR(report.objective.value_or(0.0), -2.4, 1e-9) << name;
    }
}

/// Two boundaries of a kilometre across the car's way, 10 m apart, are the only lane. The one whose midpoint
/// is 1.25 m from the car costs 1.2 * (1000 / 1.25)^4, and the other one far less.
TEST(ExtremeScenes, AnExpensiveLaneIsFoundIfItIsTheOnlyOne) {
    Scene scene = tests::cones_at({{0.75, 499}, {0.75, -501}, {10.75, 499}, {10.75, -501}});
    RldParameters parameters;
    parameters.d_e = parameters.d_t = parameters.d_h = parameters.d_max = 1000.0;
    parameters.d_near = 500.0;
    parameters.theta_heading = std::numbers::pi / 2.0;
    const double dear = 1.2 * std::pow(1000.0 / 1.25, 4);
    const double other = 1.2 * std::pow(1000.0 / std::hypot(10.75, 1.0), 4);
    for (const auto& [name, report] : exact_reports(scene, parameters)) {
        EXPECT_EQ(report.status, SolveStatus::optimal) << name << ": " << report.message;
        EXPECT_NEAR(report.objective.value_or(0.0), dear + other - 2.0, 1e-9 * dear) << name;
    }
}

/// The parameters allow edges of kilometres, and the weights are at the end of their range: costs of 1e26. A
/// solver that cannot handle them says so.
TEST(ExtremeScenes, CostsThatNoLibraryAcceptsAreAnError) {
    Scene scene;
    for (const double y : {-40'000.0, 40'000.0}) {
        for (const double x : {0.25, 0.75, 1.25})
            scene.cones.push_back({static_cast<ConeId>(scene.cones.size()), {x, y}});
    }
    RldParameters parameters{.d_e = 1000.0, .d_t = 1000.0, .w_p = 1e6, .s_crit = 1e6};
    for (Cone& cone : scene.cones) cone.position.y() *= 0.4;
    ASSERT_FALSE(make_problem(scene, parameters).edges.empty());
    for (const RldSolverEntry& entry : rld_solvers()) {
        const RldReport report =
            solve_scene(*entry.make(Formulation::tight), scene, parameters, {.limits = {kLimit_ms}}).report;
        const bool refuses = entry.has(SolverTrait::refuses_huge_costs);
        EXPECT_EQ(report.status == SolveStatus::error, refuses) << entry.name << ": " << report.message;
        if (refuses) {
            EXPECT_THAT(report.message, testing::HasSubstr("too large for "));
        }
        EXPECT_FALSE(report.lane_graph) << entry.name;
    }
}

}  // namespace
}  // namespace conelane
