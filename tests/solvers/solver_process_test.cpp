// Effects of a solve on its process: SIGINT is the program's, and no library's assertion ends the process.

#include "model/formulation_parts.hpp"
#include "solvers/milp/detail/own_process.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/solver_cases.hpp"

#include <csignal>
#include <new>
#include <stdexcept>
#include <thread>

#include <unistd.h>

namespace conelane {
namespace {

constexpr unsigned kMaxDuration_s = 60;

/// Solves repeatedly; SIGINT comes from another thread meanwhile. Relaxations of the printed rows with 40
/// cones take seconds, so nearly all of the time is spent inside Clp.
[[noreturn]] void be_interrupted_in(const tests::SolverCase& tested) {
    alarm(kMaxDuration_s);  // if SIGINT has no effect, this ends the process
    const std::unique_ptr<RldSolver> solver = tested.entry->make(tested.formulation);
    const LaneGraphProblem problem = make_problem(tests::random_scene(1, 40), {}, solver->extent());
    const std::jthread interrupter([] {
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
        kill(getpid(), SIGINT);
    });
    while (true) (void)solver->solve(problem, {});
}

class Interrupt : public testing::TestWithParam<tests::SolverCase> {
  protected:
    void SetUp() override { testing::FLAGS_gtest_death_test_style = "threadsafe"; }
};

TEST_P(Interrupt, EndsAProgramThatHasNoHandler) {
    EXPECT_EXIT(be_interrupted_in(GetParam()), testing::KilledBySignal(SIGINT), "");
}

volatile std::sig_atomic_t interrupts = 0;

/// A handler that the program has installed is still there after a solve, and is called during one.
TEST_P(Interrupt, IsSeenByTheProgramsHandler) {
    const auto before = std::signal(SIGINT, [](int) { interrupts = interrupts + 1; });
    interrupts = 0;
    const std::unique_ptr<RldSolver> solver = GetParam().entry->make(GetParam().formulation);
    const LaneGraphProblem problem = make_problem(tests::random_scene(1, 30), {}, EdgeExtent::all_pairs);
    {
        // The second is sent when the first was seen: two pending signals of one kind arrive as one.
        const std::jthread interrupter([] {
            for (int sent = 0; sent < 2; ++sent) {
                std::this_thread::sleep_for(std::chrono::milliseconds(100));
                kill(getpid(), SIGINT);
                while (interrupts <= sent) std::this_thread::sleep_for(std::chrono::milliseconds(1));
            }
        });
        const RldReport report = solver->solve(problem, {.limits = {400.0}});
        EXPECT_NE(report.status, SolveStatus::error) << report.message;
    }
    EXPECT_EQ(interrupts, 2);
    std::signal(SIGINT, before);
}

std::vector<tests::SolverCase> solvers_of_printed_rows() {
    std::vector<tests::SolverCase> all = tests::solver_cases();
    std::erase_if(all, [](const tests::SolverCase& c) { return c.formulation != Formulation::paper; });
    return all;
}

INSTANTIATE_TEST_SUITE_P(PrintedRows, Interrupt, testing::ValuesIn(solvers_of_printed_rows()),
                         [](const auto& test) {
                             std::string name(test.param.entry->name);
                             std::ranges::replace(name, '-', '_');
                             return name;
                         });

/// What a library does to its process is an error of the solve.
TEST(OwnProcess, ReportsHowItEnded) {
    const auto message = [](const std::function<void()>& fate) {
        const MilpReport report = detail::in_own_process([&] {
            fate();
            return MilpReport{.status = SolveStatus::optimal};
        });
        EXPECT_EQ(report.status, SolveStatus::error);
        EXPECT_TRUE(report.point.empty());
        return report.message;
    };
    const auto fail_assertion = [] {
        std::fputs("loading\nclp.cpp:1: Assertion `lowerValue <= upperValue' failed.\n", stderr);
        std::abort();
    };
    EXPECT_EQ(message(fail_assertion), "the library ended its process by signal " + std::to_string(SIGABRT) +
                                           ": clp.cpp:1: Assertion `lowerValue <= upperValue' failed.");
    EXPECT_EQ(message([] { (void)raise(SIGKILL); }), "the library ended its process by signal 9");
    EXPECT_EQ(message([] { throw std::runtime_error("no basis"); }), "no basis");
    EXPECT_THROW(message([] { throw std::bad_alloc(); }), std::bad_alloc);
}

TEST(OwnProcess, GivesTheWholeReport) {
    MilpReport wanted{.status = SolveStatus::feasible,
                      .stopped_by = StopReason::time,
                      .bound = -2.5,
                      .nodes = 7,
                      .message = "late"};
    wanted.point.assign(100'000, 0.25);  // more than a pipe holds
    const MilpReport report = detail::in_own_process([&] {
        std::fputs("a warning\n", stderr);
        return wanted;
    });
    EXPECT_EQ(report.status, wanted.status);
    EXPECT_EQ(report.stopped_by, wanted.stopped_by);
    EXPECT_EQ(report.point, wanted.point);
    EXPECT_EQ(report.bound, wanted.bound);
    EXPECT_EQ(report.nodes, wanted.nodes);
    EXPECT_EQ(report.message, wanted.message);
}

/// A scene on which CBC's feasibility pump always fails an assertion of Clp.
TEST(CbcMain, SolvesWhatTheFeasibilityPumpAbortedOn) {
    constexpr std::pair<double, double> kCones[] = {
        {13.203246, -10.469978}, {19.8542, 1.4488},       {15.09518, -16.433888}, {16.7573, -2.6786},
        {22.779535, -2.016967},  {20.3092, -2.7153},      {23.451, 10.7345},      {13.931565, -2.062864},
        {16.4778, 1.5947},       {26.337545, -3.423048},  {25.260876, -7.583478}, {25.273619, 4.861673},
        {27.2656, 9.9162},       {17.344899, -15.598792}, {27.929, 1.1358},       {20.1299, 15.1719},
        {31.9769, 1.0164},       {25.837844, 10.628586},  {23.90863, 6.114528},   {25.6087, 10.0986},
        {18.926969, -12.454994}, {30.975316, -1.243058},  {24.3936, 1.2254},      {24.3774, -2.725},
        {29.690921, 2.784989},   {15.096821, 10.376269},  {20.8608, 13.3936},     {15.848653, -8.083543},
        {29.108, -2.9807},       {22.0263, 11.9073}};
    Scene scene;
    scene.pose = {{13.466225, -0.437298}, -0.04135656};
    for (const auto& [x, y] : kCones)
        scene.cones.push_back({static_cast<ConeId>(scene.cones.size()), {x, y}});
    const LaneGraphProblem problem = make_problem(scene, {});
    const RldReport reference = find_rld_solver("path-pair")->make(Formulation::tight)->solve(problem, {});
    const std::unique_ptr<RldSolver> solver = find_rld_solver("cbc-main")->make(Formulation::tight);
    for (int time = 0; time < 3; ++time) {
        const RldReport report = solver->solve(problem, {});
        ASSERT_EQ(report.status, SolveStatus::optimal) << report.message;
        EXPECT_NEAR(*report.objective, *reference.objective, 1e-6);
    }
}

}  // namespace
}  // namespace conelane
