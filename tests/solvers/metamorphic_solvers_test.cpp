// Transformed scenes have the same optimum, for every solver and every formulation that it uses.

#include "solvers/path_pair/path_pair_solver.hpp"
#include "tests/support/metamorphic.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/solver_cases.hpp"

#include <tuple>

namespace conelane {
namespace {

using tests::Change;
using tests::SolverCase;

/// The tolerance of an LP.
constexpr double kObjectiveTolerance = 1e-6;

RldParameters parameters_of(std::uint64_t seed) {
    RldParameters parameters = seed % 2 == 0 ? RldParameters{} : with_shape_costs({});
    parameters.pairing = seed % 4 < 2 ? Pairing::near_far : Pairing::paper;
    return parameters;
}

RldParameters with_lengths_scaled(RldParameters parameters, double factor) {
    for (const auto& fields : {rld_parameter_fields(), rld_extra_fields()}) {
        for (const RldParameterField& field : fields) {
            if (field.unit == "m") parameters.*field.value *= factor;
        }
    }
    return parameters;
}

/// The objective of a lane of `original`, whose cones the transformation has renumbered and reordered.
double objective_of(const LaneGraph& graph, const Scene& original, const LaneGraphProblem& changed_problem,
                    const Scene& changed, const Change& change) {
    LaneGraph same;
    const auto place = [&](std::size_t cone) {
        const ConeId id = change.new_id(original.cones[cone].id);
        return static_cast<std::size_t>(std::ranges::find(changed.cones, id, &Cone::id) -
                                        changed.cones.begin());
    };
    for (const Edge& edge : graph.edges) same.edges.push_back(make_edge(place(edge.i), place(edge.j)));
    std::ranges::sort(same.edges);
    EXPECT_TRUE(is_feasible(changed_problem, same));
    return objective(changed_problem, same);
}

struct Solved {
    Scene scene;
    LaneGraphProblem problem;
    RldReport report;
};

Solved solve(RldSolver& solver, Scene scene, const RldParameters& parameters) {
    Solved solved{std::move(scene), {}, {}};
    solved.problem = make_problem(solved.scene, parameters, solver.extent());
    solved.report = solver.solve(solved.problem, {});
    return solved;
}

/// Status and objective are equal, and each lane has the same cost in the other scene.
void expect_same_optimum(const Solved& original, const Solved& changed, const Change& change) {
    const RldReport& a = original.report;
    const RldReport& b = changed.report;
    ASSERT_NE(a.status, SolveStatus::error) << a.message;
    ASSERT_EQ(b.status, a.status) << b.message;
    if (a.status != SolveStatus::optimal) return;
    // For these, positions are multiples of a micrometre, and the midpoints of edges are rounded.
    const double tolerance = change.name == "MovedFar" ? 1e-5 : kObjectiveTolerance;
    EXPECT_NEAR(*b.objective, *a.objective, tolerance);
    EXPECT_NEAR(objective_of(*a.lane_graph, original.scene, changed.problem, changed.scene, change),
                *b.objective, tolerance);
}

/// The answer of a heuristic depends on the order of its columns and on the last bits of its numbers. But it
/// is always a lane, and not better than the optimum, which path-pair knows.
void expect_no_better(const Solved& changed) {
    if (!changed.report.lane_graph) return;
    EXPECT_TRUE(is_feasible(changed.problem, *changed.report.lane_graph));
    const RldReport optimum = make_path_pair_solver()->solve(changed.problem, {});
    ASSERT_EQ(optimum.status, SolveStatus::optimal);
    EXPECT_GE(*changed.report.objective, *optimum.objective - kObjectiveTolerance);
}

void expect_same(const Solved& original, const Solved& changed, const Change& change, bool exact) {
    if (exact) {
        expect_same_optimum(original, changed, change);
    } else {
        expect_no_better(changed);
    }
    // Ids and sides influence no number of a problem.
    if (change.name == "Renumbered" || change.name == "Mirrored") {
        EXPECT_EQ(changed.report.status, original.report.status);
        EXPECT_EQ(changed.report.lane_graph, original.report.lane_graph);
    }
}

class SolverMetamorphic : public testing::TestWithParam<std::tuple<SolverCase, Change>> {};

/// Scenes of another size have the same optimum if the lengths of the parameters change too.
std::vector<Change> changes_and_scales() {
    std::vector<Change> all = tests::changes();
    all.push_back({"Quarter", [](Scene s) { return tests::scaled(std::move(s), 0.25); }});
    all.push_back({"Threefold", [](Scene s) { return tests::scaled(std::move(s), 3.0); }});
    return all;
}

TEST_P(SolverMetamorphic, FindsTheSameOptimum) {
    const auto& [tried, change] = GetParam();
    const double factor = change.name == "Quarter" ? 0.25 : change.name == "Threefold" ? 3.0 : 1.0;
    const auto solver = tried.entry->make(tried.formulation);
    const std::uint64_t seeds = tried.formulation == Formulation::paper ? 12 : 24;
    std::size_t lanes = 0;
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        // exhaustive takes at most nine cones, and one is added.
        const Scene scene = tests::on_grid(tests::random_scene(seed, 8));
        const Solved original = solve(*solver, scene, parameters_of(seed));
        const Solved changed =
            solve(*solver, change.apply(scene), with_lengths_scaled(parameters_of(seed), factor));
        expect_same(original, changed, change, tried.entry->has(SolverTrait::exact));
        if (original.report.lane_graph) ++lanes;
    }
    // The number of lanes that a heuristic finds is not compared.
    if (tried.entry->has(SolverTrait::exact)) {
        EXPECT_GE(lanes, seeds / 4);
    }
}

/// Many cones, for which all other solvers take too long.
class PathPairMetamorphic : public testing::TestWithParam<Change> {};

TEST_P(PathPairMetamorphic, FindsTheSameOptimumAmongManyCones) {
    const auto solver = make_path_pair_solver();
    std::size_t lanes = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const Scene scene = tests::on_grid(tests::random_scene(seed, 30));
        const Solved original = solve(*solver, scene, parameters_of(seed));
        const Solved changed = solve(*solver, GetParam().apply(scene), parameters_of(seed));
        expect_same(original, changed, GetParam(), true);
        if (original.report.lane_graph) ++lanes;
    }
    EXPECT_GE(lanes, 30U);
}

INSTANTIATE_TEST_SUITE_P(Registry, SolverMetamorphic,
                         testing::Combine(testing::ValuesIn(tests::solver_cases()),
                                          testing::ValuesIn(changes_and_scales())),
                         [](const auto& test) {
                             return case_name(std::get<0>(test.param)) + "_" +
                                    std::string(std::get<1>(test.param).name);
                         });
INSTANTIATE_TEST_SUITE_P(Changes, PathPairMetamorphic, testing::ValuesIn(tests::changes()),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace conelane
