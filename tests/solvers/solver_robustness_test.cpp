// Requirements of every solver of the registry, including heuristics: little time, degenerate scenes, unusual
// limits and failing backends.

#include "conelane/check.hpp"
#include "solvers/milp/milp_solver.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"
#include "solvers/relaxation/relaxation_solver.hpp"
#include "tests/support/cones_at.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/solver_cases.hpp"

#include <stdexcept>
#include <thread>

namespace conelane {
namespace {

using tests::cones_at;
using tests::solver_cases;
using tests::SolverCase;

Scene four_cones() {
    return cones_at({{4, 1.5}, {7.2, 1.5}, {4, -1.5}, {7.2, -1.5}});
}
const LaneGraph kFourConesLane{{{0, 1}, {2, 3}}};

class SolverRobustness : public testing::TestWithParam<SolverCase> {
  protected:
    std::unique_ptr<RldSolver> solver = GetParam().entry->make(GetParam().formulation);

    LaneGraphProblem problem_of(const Scene& scene) { return make_problem(scene, {}, solver->extent()); }

    /// The report is right without a limit: there is no lane. A heuristic need not prove it.
    static void expect_no_lane(const RldReport& report) {
        EXPECT_TRUE(report.status == SolveStatus::infeasible ||
                    (!GetParam().entry->has(SolverTrait::exact) && report.status == SolveStatus::stopped))
            << testing::PrintToString(report.status) << ": " << report.message;
        EXPECT_FALSE(report.stopped_by.has_value());
        EXPECT_FALSE(report.lane_graph.has_value());
    }

    /// The report claims nothing that contradicts the reference, which was solved without a limit.
    static void expect_true(const RldReport& report, const LaneGraphProblem& problem,
                            const RldReport& reference) {
        const bool has_lane = reference.status == SolveStatus::optimal;
        ASSERT_NE(report.status, SolveStatus::error) << report.message;
        if (report.status == SolveStatus::infeasible) {
            EXPECT_FALSE(has_lane);
        }
        if (report.bound && has_lane) {
            EXPECT_LE(*report.bound, *reference.objective + 1e-6);
        }
        ASSERT_EQ(report.lane_graph.has_value(),
                  report.status == SolveStatus::optimal || report.status == SolveStatus::feasible);
        if (!report.lane_graph) return;
        ASSERT_TRUE(has_lane);
        EXPECT_TRUE(is_feasible(problem, *report.lane_graph));
        EXPECT_GE(*report.objective, *reference.objective - 1e-6);
        if (report.status == SolveStatus::optimal) {
            EXPECT_NEAR(*report.objective, *reference.objective, 1e-6);
        }
    }
};

/// Limits spread over the time of the solve, so that the deadline is in each of its parts.
TEST_P(SolverRobustness, ADeadlineAnywhereInTheSolveMakesNoFalseProof) {
    constexpr int kLimits = 60;
    const std::unique_ptr<RldSolver> path_pair = make_path_pair_solver();
    int stopped = 0;
    for (const std::uint64_t seed : {1, 3, 5}) {
        const std::size_t max_cones = GetParam().entry->max_cones.value_or(24);
        const std::size_t cones =
            std::min<std::size_t>(max_cones, GetParam().formulation == Formulation::paper ? 10 : 24);
        const LaneGraphProblem problem = problem_of(tests::random_scene(seed, cones));
        const RldReport reference = path_pair->solve(problem, {});
        const Stopwatch watch;
        const RldReport unlimited = solver->solve(problem, {});
        const double whole_ms = std::min(watch.elapsed_ms(), 60.0);
        if (unlimited.status != SolveStatus::error) expect_true(unlimited, problem, reference);
        for (int k = 0; k < kLimits; ++k) {
            const double limit_ms = 1.1 * whole_ms * k / kLimits;
            SCOPED_TRACE(testing::Message() << "seed " << seed << ", limit " << limit_ms << " ms");
            const RldReport report = solver->solve(problem, {.limits = {limit_ms}});
            if (unlimited.status == SolveStatus::error && report.status == SolveStatus::error) continue;
            expect_true(report, problem, reference);
            if (report.stopped_by) ++stopped;
        }
    }
    EXPECT_GE(stopped, 3) << "limits of zero stop every solve";
}

TEST_P(SolverRobustness, ALimitThatHasPassedStopsAtOnce) {
    for (const double limit_ms : {0.0, -1.0, -1e300, -std::numeric_limits<double>::infinity()}) {
        const RldReport report = solver->solve(problem_of(four_cones()), {.limits = {limit_ms}});
        EXPECT_EQ(report.status, SolveStatus::stopped) << limit_ms;
        EXPECT_EQ(report.stopped_by, StopReason::time);
        EXPECT_FALSE(report.bound && *report.bound > -2.0 + 1e-6);
    }
}

/// The integers of a clock, a backend's seconds and its milliseconds overflow long before a double. The
/// answer of a heuristic must be the one without a limit.
TEST_P(SolverRobustness, AHugeFiniteLimitIsNoLimit) {
    const RldReport unlimited = solver->solve(problem_of(four_cones()), {});
    if (GetParam().entry->has(SolverTrait::exact)) {
        ASSERT_EQ(unlimited.status, SolveStatus::optimal) << unlimited.message;
    } else {
        ASSERT_THAT(unlimited.status, testing::AnyOf(SolveStatus::feasible, SolveStatus::stopped))
            << unlimited.message;
    }
    for (const double limit_ms : {1e9, 1e13, 1e19, 1e300, std::numeric_limits<double>::max()}) {
        const RldReport report = solver->solve(problem_of(four_cones()), {.limits = {limit_ms}});
        EXPECT_FALSE(report.stopped_by.has_value()) << limit_ms;
        EXPECT_EQ(report.status, unlimited.status) << limit_ms << ": " << report.message;
        EXPECT_EQ(report.lane_graph, unlimited.lane_graph) << limit_ms;
    }
}

TEST_P(SolverRobustness, NoNumberAsALimitIsAnError) {
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    for (const SolveLimits& limits : {SolveLimits{kNaN}, SolveLimits{10.0, kNaN}, SolveLimits{10.0, -1.0}}) {
        const RldReport report = solver->solve(problem_of(four_cones()), {.limits = limits});
        EXPECT_EQ(report.status, SolveStatus::error);
        EXPECT_FALSE(report.message.empty());
        EXPECT_FALSE(report.lane_graph.has_value());
    }
}

TEST_P(SolverRobustness, TooFewConesForALane) {
    const std::vector<Point> all{{4, 1.5}, {7.2, 1.5}, {4, -1.5}};
    for (std::size_t count = 0; count <= all.size(); ++count) {
        const std::vector<Point> some(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count));
        SCOPED_TRACE(testing::Message() << count << " cones");
        expect_no_lane(solver->solve(problem_of(cones_at(some)), {}));
    }
}

TEST_P(SolverRobustness, AllConesAtOnePlace) {
    for (const Point& place : {Point(0, 0), Point(5, 1), Point(40, 0), Point(1e6, -1e6)}) {
        SCOPED_TRACE(testing::Message() << "at " << place.x() << ", " << place.y());
        expect_no_lane(solver->solve(problem_of(cones_at(std::vector<Point>(8, place))), {}));
    }
}

/// The last cone's edges cost 10^29; the printed formulation lists them.
TEST_P(SolverRobustness, ACostBeyondWhatABackendTakesIsAnErrorOrHasNoEffect) {
    Scene scene = four_cones();
    scene.cones.push_back({4, {1e15, 0.0}});
    const LaneGraphProblem problem = problem_of(scene);
    const RldReport report = solver->solve(problem, {});
    if (report.status == SolveStatus::error) {
        EXPECT_THAT(report.message, testing::HasSubstr("too large"));
        return;
    }
    expect_true(report, problem, make_path_pair_solver()->solve(make_problem(scene, {}), {}));
}

/// The solver finds nothing better than the start before the limit, so the start is the answer.
TEST_P(SolverRobustness, AStartOutlivesTheLimit) {
    const RldReport report =
        solver->solve(problem_of(four_cones()), {.limits = {0.0}, .start = &kFourConesLane});
    EXPECT_EQ(report.status, SolveStatus::feasible) << report.message;
    EXPECT_EQ(report.stopped_by, StopReason::time);
    EXPECT_EQ(report.lane_graph, kFourConesLane);
    EXPECT_NEAR(report.objective.value_or(0.0), -2.0, 1e-9);
}

/// One instance in each thread: they share no state that matters. Some libraries have to take turns.
TEST_P(SolverRobustness, SolvesTheSameInThreads) {
    constexpr std::uint64_t kSeeds = 4;
    const auto solve_all = [] {
        const std::unique_ptr<RldSolver> own = GetParam().entry->make(GetParam().formulation);
        std::vector<RldReport> reports;
        for (std::uint64_t seed = 0; seed < kSeeds; ++seed)
            reports.push_back(own->solve(make_problem(tests::random_scene(seed, 8), {}, own->extent()), {}));
        return reports;
    };
    const std::vector<RldReport> alone = solve_all();
    std::vector<std::vector<RldReport>> together(3);
    {
        std::vector<std::jthread> threads;
        for (std::vector<RldReport>& reports : together)
            threads.emplace_back([&reports, &solve_all] { reports = solve_all(); });
    }
    for (const std::vector<RldReport>& reports : together) {
        ASSERT_EQ(reports.size(), alone.size());
        for (std::size_t scene = 0; scene < alone.size(); ++scene) {
            EXPECT_EQ(reports[scene].status, alone[scene].status) << reports[scene].message;
            EXPECT_EQ(reports[scene].lane_graph, alone[scene].lane_graph);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Registry, SolverRobustness, testing::ValuesIn(solver_cases()),
                         [](const auto& test) { return case_name(test.param); });

/// A backend that fails in one of several ways.
class FailingMilpSolver {
  public:
    enum class Way { load_throws, throws, throws_no_std_exception, reports, gives_a_wrong_point };
    explicit FailingMilpSolver(Way way) : way_(way) {}

    std::unique_ptr<MilpSession> operator()(const BinaryProgram& program, std::uint64_t /*seed*/) const {
        if (way_ == Way::load_throws) throw std::runtime_error("no memory for the rows");
        return std::make_unique<Session>(way_, program.columns.size());
    }

  private:
    struct NoStdException {};
    struct Session : MilpSession {
        Session(Way failure, std::size_t column_count) : way(failure), columns(column_count) {}
        MilpReport solve(const MilpLimits& /*limits*/) override {
            if (way == Way::throws) throw std::logic_error("broken basis");
            if (way == Way::throws_no_std_exception) throw NoStdException{};
            MilpReport report;
            if (way == Way::reports) {
                report.message = "singular";
            } else {
                report.status = SolveStatus::optimal;
                report.point.assign(columns, 0.0);
            }
            return report;
        }
        void add_rows(std::span<const ProgramRow> /*rows*/) override {}
        Way way;
        std::size_t columns;
    };
    Way way_;
};

TEST(FailingBackend, IsAnErrorWithAMessageThatKeepsAFeasibleStart) {
    using Way = FailingMilpSolver::Way;
    const LaneGraphProblem problem = make_problem(four_cones(), {});
    for (const Way way : {Way::load_throws, Way::throws, Way::throws_no_std_exception, Way::reports,
                          Way::gives_a_wrong_point}) {
        SCOPED_TRACE(static_cast<int>(way));
        const auto solver = make_milp_rld_solver(FailingMilpSolver(way), {});
        const RldReport alone = solver->solve(problem, {});
        EXPECT_EQ(alone.status, SolveStatus::error);
        EXPECT_FALSE(alone.message.empty());
        EXPECT_FALSE(alone.lane_graph.has_value());
        const LaneGraph infeasible{{{0, 2}, {1, 3}}};
        EXPECT_FALSE(solver->solve(problem, {.start = &infeasible}).lane_graph.has_value());
        const RldReport started = solver->solve(problem, {.start = &kFourConesLane});
        EXPECT_EQ(started.status, SolveStatus::error);
        EXPECT_FALSE(started.message.empty());
        EXPECT_EQ(started.lane_graph, kFourConesLane);
        EXPECT_NEAR(started.objective.value_or(0.0), -2.0, 1e-9);
    }
}

TEST(FailingBackend, ARelaxationThatThrowsIsAnErrorToo) {
    const LaneGraphProblem problem = make_problem(four_cones(), {});
    const auto solver =
        make_relaxation_solver([](const LaneGraphProblem&, const std::vector<double>&,
                                  const Deadline&) -> std::optional<std::vector<double>> { throw 7; });
    EXPECT_EQ(solver->solve(problem, {}).status, SolveStatus::error);
    EXPECT_EQ(solver->solve(problem, {.start = &kFourConesLane}).lane_graph, kFourConesLane);
}

TEST(FailingBackend, OutOfMemoryIsPassedOn) {
    const LaneGraphProblem problem = make_problem(four_cones(), {});
    const auto solver = make_relaxation_solver(
        [](const LaneGraphProblem&, const std::vector<double>&,
           const Deadline&) -> std::optional<std::vector<double>> { throw std::bad_alloc(); });
    EXPECT_THROW((void)solver->solve(problem, {}), std::bad_alloc);
}

}  // namespace
}  // namespace conelane
