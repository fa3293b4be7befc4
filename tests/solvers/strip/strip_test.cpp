#include "model/strip_model.hpp"
#include "solvers/milp/strip_milp.hpp"
#include "solvers/registry.hpp"
#include "tests/support/slowness.hpp"
#include "tests/support/strip_scenes.hpp"

#include <fmt/format.h>

namespace conelane::tests {
namespace {

/// Every strip, cone by cone: the least cost of each lane.
class EveryStrip {
  public:
    explicit EveryStrip(const StripProblem& problem) : problem_(problem) {
        for (std::size_t r = 0; r < problem.rungs.size(); ++r) {
            const StripRung& rung = problem.rungs[r];
            if (rung.may_start) go_on(r, {{rung.left}, {rung.right}}, rung.start_cost);
        }
    }
    /// Ascending.
    [[nodiscard]] std::vector<double> costs() const {
        std::vector<double> costs;
        for (const auto& [lane, cost] : least_) costs.push_back(cost);
        std::ranges::sort(costs);
        return costs;
    }

  private:
    void go_on(std::size_t rung, const StripLane& lane, double cost) {
        ASSERT_LT(++steps_, 3'000'000) << "too many strips for this test";
        if (problem_.rungs[rung].may_end && lane.left.size() > 1 && lane.right.size() > 1) {
            const double whole = cost + end_cost(lane.left) + end_cost(lane.right);
            const auto [known, is_new] = least_.emplace(std::pair(lane.left, lane.right), whole);
            known->second = std::min(known->second, whole);
        }
        for (const StripTriangle& triangle : problem_.leaving(rung)) {
            const std::size_t cone = problem_.entered(triangle);
            if (std::ranges::count(lane.left, cone) + std::ranges::count(lane.right, cone) > 0) continue;
            StripLane longer = lane;
            auto& side = triangle.is_left ? longer.left : longer.right;
            const std::size_t in =
                side.size() > 1 ? place(side[side.size() - 2], side.back()) : problem_.degree(side.back());
            const double turn = problem_.step_cost(side.back(), triangle.is_left, in, triangle.out);
            if (!(turn < StripProblem::kForbidden)) continue;
            side.push_back(cone);
            go_on(triangle.to, longer, cost + triangle.cost + turn);
        }
    }
    [[nodiscard]] std::size_t place(std::size_t from, std::size_t cone) const {
        const auto& incident = problem_.graph.incident[cone];
        const auto edge =
            std::ranges::find_if(incident, [&](std::size_t e) { return problem_.other(e, cone) == from; });
        return static_cast<std::size_t>(edge - incident.begin());
    }
    [[nodiscard]] double end_cost(const std::vector<std::size_t>& side) const {
        return problem_.end_cost(side.back(), place(side[side.size() - 2], side.back()));
    }

    const StripProblem& problem_;
    std::map<std::pair<std::vector<std::size_t>, std::vector<std::size_t>>, double> least_;
    int steps_ = 0;
};

/// Nothing below the optimum is claimed, and nothing but the optimum.
void expect_optimum(const StripReport& report, const std::optional<double>& least) {
    ASSERT_EQ(report.status, least ? SolveStatus::optimal : SolveStatus::infeasible) << report.message;
    if (!least) return;
    EXPECT_NEAR(*report.objective, *least, 1e-6);
    EXPECT_LE(*report.bound, *report.objective);
    EXPECT_NEAR(*report.bound, *least, 1e-6);
}

TEST(StripSolver, FindsWhatEveryStripIncludes) {
    StripSolver solver;
    int lanes = 0;
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        SCOPED_TRACE(seed);
        const Scene scene =
            seed % 3 == 0 ? strewn_scene(7, 12.0, 10.0, seed) : random_scene(seed, 5 + seed % 4);
        const StripProblem problem =
            make_strip_problem(scene, random_strip_parameters(seed, seed % 2 == 0 ? 0 : 3));
        const std::vector<double> costs = EveryStrip(problem).costs();
        const StripReport report = solver.solve(problem, {.lanes = 5});
        ASSERT_NO_FATAL_FAILURE(
            expect_optimum(report, costs.empty() ? std::nullopt : std::optional(costs.front())));
        ASSERT_EQ(report.lanes.size(), std::min<std::size_t>(5, costs.size()));
        for (std::size_t k = 0; k < report.lanes.size(); ++k)
            EXPECT_NEAR(cheapest_strip(problem, report.lanes[k])->cost, costs[k], 1e-9);
        lanes += costs.empty() ? 0 : 1;
    }
    EXPECT_GT(lanes, 200);
}

TEST(StripSolver, AgreesWithABackendOfTheProgram) {
    StripSolver solver;
    for (std::uint64_t seed = 0; seed < 16; ++seed) {
        SCOPED_TRACE(seed);
        const Scene scene =
            seed % 4 == 0 ? strewn_scene(14, 16.0, 12.0, seed) : random_scene(1000 + seed, 10 + seed % 5);
        const StripProblem problem = make_strip_problem(scene, random_strip_parameters(seed));
        for (const MilpBackend& backend : milp_backends()) {
            if (backend.entry.name == "cbc-main" && seed % 8 != 0) continue;
            SCOPED_TRACE(backend.entry.name);
            const StripReport by_program = solve_strip_by_milp(backend, problem, {});
            ASSERT_NO_FATAL_FAILURE(expect_optimum(solver.solve(problem, {}), by_program.objective));
            EXPECT_NE(by_program.status, SolveStatus::error) << by_program.message;
        }
    }
}

/// With (29) as costs and the same gates: both optima are the same if RLD's is a strip.
void expect_agreement(std::uint64_t cases) {
    StripSolver solver;
    const auto rld = find_rld_solver("path-pair")->make(Formulation::tight);
    std::uint64_t agreed = 0;
    std::uint64_t no_strips = 0;
    for (std::uint64_t seed = 0; seed < cases; ++seed) {
        SCOPED_TRACE(seed);
        const Scene scene = random_scene(seed, 8 + seed % 9);
        const RldParameters parameters = rld_without_width_and_heading();
        const LaneGraphProblem problem = make_problem(scene, parameters);
        const RldReport optimum = rld->solve(problem, {});
        const StripProblem strips = make_strip_problem(scene, strip_parameters_of(parameters));
        const StripReport strip = solver.solve(strips, {});
        ASSERT_NE(strip.status, SolveStatus::error) << strip.message;
        ASSERT_TRUE(optimum.status == SolveStatus::optimal || optimum.status == SolveStatus::infeasible);
        if (strip.objective) {
            ASSERT_TRUE(is_feasible(problem, *strip.lane_graph));
            EXPECT_NEAR(objective(problem, *strip.lane_graph), *strip.objective, 1e-9);
            EXPECT_GE(*strip.objective, *optimum.objective - 1e-9);
        }
        if (!optimum.lane_graph) continue;
        const auto both = paths(*optimum.lane_graph, problem.cone_count);
        std::optional<StripOfLane> as_strip;
        for (std::vector<std::size_t> a : {(*both)[0], (*both)[1]}) {
            std::vector<std::size_t> b = a == (*both)[0] ? (*both)[1] : (*both)[0];
            for (auto* path : {&a, &b})
                if (!problem.near[path->front()]) std::ranges::reverse(*path);
            if (const auto found = cheapest_strip(strips, {a, b})) as_strip = found;
        }
        if (!as_strip) {
            ++no_strips;
            continue;
        }
        ++agreed;
        ASSERT_TRUE(strip.objective);
        EXPECT_NEAR(*strip.objective, *optimum.objective, 1e-9);
    }
    EXPECT_GT(agreed, cases / 3);
    std::cout << agreed << " optima are strips, " << no_strips << " are not\n";
}

TEST(StripSolver, AgreesWithRldWhereItsOptimumIsAStrip) {
    const char* const cases = std::getenv("CONELANE_STRIP_CASES");
    expect_agreement(cases != nullptr ? std::strtoull(cases, nullptr, 10) : 300);
}

TEST(StripSolver, ClaimsNothingThatALimitPrevents) {
    StripSolver solver;
    const StripProblem problem = make_strip_problem(random_scene(3, 22), random_strip_parameters(3));
    const StripReport whole = solver.solve(problem, {});
    ASSERT_EQ(whole.status, SolveStatus::optimal) << whole.message;
    EXPECT_EQ(solver.solve(problem, {.limits = {.time_limit_ms = 0.0}}).status, SolveStatus::stopped);
    for (const std::size_t labels : {1U, 10U, 30U, 100U, 1000U}) {
        const StripReport part = solver.solve(problem, {.max_labels = labels});
        ASSERT_NE(part.status, SolveStatus::error) << part.message;
        if (part.bound) {
            EXPECT_LE(*part.bound, *whole.objective + 1e-9);
        }
        if (part.objective) {
            EXPECT_GE(*part.objective, *whole.objective - 1e-9);
        }
        if (part.status == SolveStatus::optimal) {
            EXPECT_NEAR(*part.objective, *whole.objective, 1e-9);
        } else {
            EXPECT_EQ(part.stopped_by, StopReason::iterations);
        }
    }
    StripReport wrong = verified_strip(problem, {}, [&](StripReport& report) {
        report = whole;
        report.bound = *report.objective + 1.0;
    });
    EXPECT_EQ(wrong.status, SolveStatus::error);
    wrong = verified_strip(problem, {}, [&](StripReport& report) {
        report = whole;
        report.objective = *report.objective - 1.0;
    });
    EXPECT_EQ(wrong.status, SolveStatus::error);
}

TEST(StripModel, NamesColumnsAndForbidsCirculations) {
    const Scene scene = random_scene(5, 10);
    const StripProblem problem = make_strip_problem(scene, random_strip_parameters(5));
    StripModel model(problem);
    ASSERT_FALSE(model.build(Deadline()));
    const BinaryProgram& program = model.program();
    std::map<std::string, int> families;
    for (const BinaryProgram::Column& column : program.columns) ++families[std::string(column.label.family)];
    for (const char* family : {"s", "t", "y_L", "y_R", "f_L", "f_R", "b_L", "b_R", "e_L", "e_R"})
        EXPECT_GT(families[family], 0) << family;
    // Each triangle chosen that no strip from the start reaches is forbidden.
    const StripReport report = StripSolver().solve(problem, {});
    ASSERT_TRUE(report.objective) << report.message;
    const StripLane& lane = report.lanes.front();
    std::set<std::string> chosen{fmt::format("s_{}_{}", lane.left.front(), lane.right.front())};
    const StripOfLane strip = *cheapest_strip(problem, lane);
    for (const std::size_t k : strip.triangles) {
        const StripTriangle& t = problem.triangles[k];
        const auto& [l, r, may_start, may_end, cost] = problem.rungs[t.from];
        chosen.insert(t.is_left ? fmt::format("y_L_{}_{}_{}", l, problem.entered(t), r)
                                : fmt::format("y_R_{}_{}_{}", l, r, problem.entered(t)));
    }
    std::vector<double> point;
    for (const auto& column : program.columns)
        point.push_back(chosen.contains(to_string(column.label)) ? 1.0 : 0.0);
    EXPECT_TRUE(model.separate(point).empty());
    EXPECT_EQ(model.decode(point), lane);
    for (std::size_t c = 0; c < point.size(); ++c)
        if (program.columns[c].label.family == "s") point[c] = point[c] > 0.5 ? 0.0 : 1.0;
    EXPECT_FALSE(model.separate(point).empty());
}

}  // namespace
}  // namespace conelane::tests
