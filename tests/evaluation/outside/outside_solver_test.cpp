// Solvers from outside: right answers are passed on, whole and permuted programs have the same optimum, and
// no fault or false claim of a program is accepted or does harm.

#include "evaluation/outside/outside_solver.hpp"

#include "conelane/invalid_input.hpp"
#include "model/connecting_flow.hpp"
#include "solvers/milp/milp_solver.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"
#include "tests/support/file_test.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/straight_lane_problem.hpp"
#include "tests/support/test_paths.hpp"

namespace conelane {
namespace {

constexpr double kSame = 1e-6;

std::string child(const std::string& arguments = "") {
    return solver_child() + " " + arguments;
}

OutsideDetector detector(const std::string& command) {
    return {OutsideDetector::Kind::program, "child", command, {}};
}

constexpr SolverPatience kShort{
    .late_ms = 400.0, .start_ms = 10000.0, .end_ms = 400.0, .failures = 4, .lost_ms = 60000.0};

/// Tests that run at the same time have temporary folders too: this program has a folder of its own.
class OwnTemporaryPlace : public testing::Environment {
  public:
    void SetUp() override {
        std::string place =
            (std::filesystem::temp_directory_path() / "conelane_outside_tests_XXXXXX").string();
        ASSERT_NE(::mkdtemp(place.data()), nullptr);
        place_ = place;
        ASSERT_EQ(::setenv("TMPDIR", place.c_str(), 1), 0);
    }
    void TearDown() override { std::filesystem::remove_all(place_); }

  private:
    std::filesystem::path place_;
};
const auto* const kPlace = testing::AddGlobalTestEnvironment(new OwnTemporaryPlace);

std::size_t folders_left() {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::temp_directory_path())) {
        if (entry.path().filename().string().starts_with("conelane_solver_")) ++count;
    }
    return count;
}

/// The optimum by path-pair, which uses no program; absent if there is no lane graph.
std::optional<double> exact(const LaneGraphProblem& problem) {
    const RldReport report = make_path_pair_solver()->solve(problem, {});
    EXPECT_TRUE(report.status == SolveStatus::optimal || report.status == SolveStatus::infeasible);
    return report.objective;
}

void expect_optimum(const RldReport& report, std::optional<double> optimum) {
    ASSERT_EQ(report.status, optimum ? SolveStatus::optimal : SolveStatus::infeasible) << report.message;
    if (!optimum) return;
    EXPECT_NEAR(*report.objective, *optimum, kSame);
    EXPECT_NEAR(*report.bound, *optimum, 1e-5);
}

LaneGraphProblem problem_of(const Scene& scene, Formulation formulation, Pairing pairing,
                            RldParameters parameters = {}) {
    parameters.pairing = pairing;
    return make_problem(scene, parameters, parts(formulation).extent);
}

/// With a high benefit of edges and low costs of turns, cycles and paths between near ends pay.
RldParameters tempting() {
    return RldParameters{.w_t = 0.02, .w_b = 3.0, .d_min = 0.5, .d_near = 8.0, .t_crit = 1000.0};
}

/// The flow replaces the rows that are added on demand: the optimum is the same. The test must include the
/// relevant case: a program without the flow whose optimum is not a lane graph.
TEST(ConnectingFlow, MakesAProgramWhole) {
    int cut_off = 0;
    int feasible = 0;
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        for (const Formulation formulation : {Formulation::tight, Formulation::paper}) {
            if (formulation == Formulation::paper && seed >= 10) continue;  // each takes 0.1 s
            for (const Pairing pairing : {Pairing::near_far, Pairing::paper}) {
                SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << to_string(formulation));
                const LaneGraphProblem problem =
                    problem_of(tests::random_scene(seed, 9), formulation, pairing, tempting());
                if (problem.edges.empty()) continue;
                const LaneGraphModel model(problem, formulation);
                BinaryProgram whole = model.program();
                add_connecting_flow(whole, problem);
                const MilpReport report = kCbc.load(whole)->solve({});
                const std::optional<double> optimum = exact(problem);
                ASSERT_EQ(report.status == SolveStatus::optimal, optimum.has_value());
                if (!optimum) continue;
                ++feasible;
                EXPECT_NEAR(*report.bound, *optimum, kSame);
                EXPECT_TRUE(is_feasible(problem, model.decode(report.point)));
                const MilpReport part = kCbc.load(model.program())->solve({});
                if (*part.bound < *optimum - kSame) ++cut_off;
            }
        }
    }
    EXPECT_GT(feasible, 30);
    EXPECT_GT(cut_off, 0);
}

TEST(PermutedProgram, IsTheSameProgramInAnotherOrder) {
    const LaneGraphProblem problem = tests::straight_lane_problem();
    const LaneGraphModel model(problem, Formulation::tight);
    const BinaryProgram& program = model.program();
    const PermutedProgram other = permuted(program, 5);
    const auto names = [](const auto& all) {
        return mapped(all, [](const auto& one) { return to_string(one.label); });
    };
    EXPECT_NE(names(other.program.columns), names(program.columns));
    EXPECT_NE(names(other.program.rows), names(program.rows));
    EXPECT_THAT(names(other.program.columns), testing::UnorderedElementsAreArray(names(program.columns)));
    EXPECT_THAT(names(other.program.rows), testing::UnorderedElementsAreArray(names(program.rows)));
    EXPECT_EQ(names(permuted(program, 5).program.columns), names(other.program.columns));
    EXPECT_NE(names(permuted(program, 6).program.columns), names(other.program.columns));
    const MilpReport first = kCbc.load(program)->solve({});
    const MilpReport second = kCbc.load(other.program)->solve({});
    EXPECT_NEAR(*first.bound, *second.bound, kSame);
    EXPECT_TRUE(is_feasible(problem, model.decode(other.point_of(second.point))));
    EXPECT_TRUE(other.point_of({}).empty());
}

struct Way {
    const char* name;
    const char* arguments;  ///< of the child
    bool all_rows;
    std::uint64_t seed;

    friend void PrintTo(const Way& way, std::ostream* out) { *out << way.name; }
};

class RightAnswers : public testing::TestWithParam<Way> {};

TEST_P(RightAnswers, AreOptima) {
    const std::size_t folders = folders_left();
    {
        int feasible = 0;
        for (const Formulation formulation : {Formulation::tight, Formulation::paper}) {
            OutsideSolver solver(detector(child(GetParam().arguments)), {formulation, GetParam().all_rows});
            for (std::uint64_t seed = 0; seed < 16; ++seed) {
                SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << to_string(formulation));
                const LaneGraphProblem problem =
                    problem_of(tests::random_scene(seed, 8), formulation, Pairing::near_far);
                const std::optional<double> optimum = exact(problem);
                const RldReport report =
                    solver.solve(problem, {.limits = {.time_limit_ms = 20000.0}, .seed = GetParam().seed});
                expect_optimum(report, optimum);
                if (!optimum) continue;
                ++feasible;
                EXPECT_EQ(solver.version(), "child 1.2");
                EXPECT_NEAR(solver.engine_ms().value(), 0.5 * report.rounds, 1e-9);
                EXPECT_EQ(report.nodes, 3 * report.rounds);
                // The start is the optimum, so nothing better is found.
                expect_optimum(solver.solve(problem, {.start = &*report.lane_graph, .seed = GetParam().seed}),
                               optimum);
            }
            solver.end();
            EXPECT_GT(solver.peak_bytes(), std::size_t{1} << 20U);
            EXPECT_LT(solver.peak_bytes(), std::size_t{1} << 33U);
        }
        EXPECT_GT(feasible, 4);
    }
    EXPECT_LE(folders_left(), folders);
}

INSTANTIATE_TEST_SUITE_P(Ways, RightAnswers,
                         testing::Values(Way{"conversation", "", false, 0}, Way{"all_rows", "", true, 0},
                                         Way{"permuted", "", false, 7},
                                         Way{"once", "once {mps} {sol}", false, 0},
                                         Way{"once_permuted_all_rows", "once {mps} {sol}", true, 3}),
                         [](const auto& test) { return std::string(test.param.name); });

struct Fault {
    const char* name;
    const char* message;
    bool in_one_shot = true;  ///< the fault also exists for a program that is run once

    friend void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.name; }
};

class Faults : public FileTest, public testing::WithParamInterface<Fault> {
  protected:
    const LaneGraphProblem problem_ = tests::straight_lane_problem();
    const SolveLimits limits_{.time_limit_ms = 1500.0};
};

TEST_P(Faults, AreErrorsAndTheNextAnswerIsRight) {
    const std::optional<double> optimum = exact(problem_);
    OutsideSolver solver(detector(child(std::string(GetParam().name) + " 2 " + path("done").string())),
                         {.patience = kShort});
    expect_optimum(solver.solve(problem_, {.limits = limits_}), optimum);
    const Stopwatch watch;
    const RldReport report = solver.solve(problem_, {.limits = limits_});
    EXPECT_LT(watch.elapsed_ms(), limits_.time_limit_ms + kShort.late_ms + 1000.0);
    EXPECT_EQ(report.status, SolveStatus::error);
    EXPECT_FALSE(report.lane_graph);
    EXPECT_FALSE(report.bound);
    EXPECT_THAT(report.message, HasSubstr(GetParam().message));
    expect_optimum(solver.solve(problem_, {.limits = limits_}), optimum);
}

TEST_P(Faults, OfAProgramThatIsRunOnceToo) {
    if (!GetParam().in_one_shot) GTEST_SKIP() << "is about a line of a conversation";
    const std::optional<double> optimum = exact(problem_);
    OutsideSolver solver(
        detector(child("once {mps} {sol} " + std::string(GetParam().name) + " " + path("done").string())),
        {.patience = kShort});
    const RldReport report = solver.solve(problem_, {.limits = limits_});
    EXPECT_EQ(report.status, SolveStatus::error);
    EXPECT_NE(report.message, "");
    expect_optimum(solver.solve(problem_, {.limits = limits_}), optimum);
}

INSTANTIATE_TEST_SUITE_P(
    All, Faults,
    testing::Values(Fault{"crash", "what went wrong"}, Fault{"exit", "exit code 3"},
                    Fault{"hang", "no answer within"}, Fault{"half-a-line", "no answer within"},
                    Fault{"endless-line", "without a newline"}, Fault{"endless-lines", "its answer:1"},
                    Fault{"no-file", "no solution file"}, Fault{"empty-file", "the file is empty"},
                    Fault{"garbage", "line 1"}, Fault{"unknown-column", "no column a_900_901"},
                    Fault{"column-twice", "twice"}, Fault{"not-a-number", "NAME VALUE"},
                    Fault{"fraction", "not integral"}, Fault{"half-a-point", "the program"},
                    Fault{"wrong-objective", "claims the objective"}, Fault{"high-bound", "claims the bound"},
                    Fault{"says-error", "no licence", false}, Fault{"wrong-type", "status", false},
                    Fault{"unknown-status", "status", false}, Fault{"no-object", "its answer", false}),
    [](const auto& test) {
        std::string name = test.param.name;
        std::ranges::replace(name, '-', '_');
        return name;
    });

class Claims : public FileTest {
  protected:
    const LaneGraphProblem problem_ = tests::straight_lane_problem();
};

/// A known lane graph refutes the claim; without one, it cannot be refuted here.
TEST_F(Claims, InfeasibilityIsRefutedByAStart) {
    const LaneGraph lane = *make_path_pair_solver()->solve(problem_, {}).lane_graph;
    // With a cutoff, the claim that nothing is below it is true of an optimum.
    OutsideSolver conversation(detector(child("claims-none 1 always")), {});
    EXPECT_EQ(conversation.solve(problem_, {.start = &lane}).status, SolveStatus::optimal);
    OutsideSolver alone(detector(child("claims-none 1 always")), {});
    EXPECT_EQ(alone.solve(problem_, {}).status, SolveStatus::infeasible);
}

TEST_F(Claims, AnOptimumWithAGapIsALaneGraphOnly) {
    OutsideSolver solver(detector(child("low-bound 1 always")), {});
    const RldReport report = solver.solve(problem_, {});
    EXPECT_EQ(report.status, SolveStatus::feasible);
    EXPECT_NEAR(*report.objective - *report.bound, 0.5, 1e-5);
    EXPECT_THAT(report.message, HasSubstr("a gap of 0.5"));
}

TEST_F(Claims, APointWithoutAStatusIsALaneGraphOnly) {
    OutsideSolver solver(detector(child("mere-point 1 always")), {});
    const RldReport report = solver.solve(problem_, {});
    EXPECT_EQ(report.status, SolveStatus::feasible);
    EXPECT_TRUE(report.lane_graph);
    EXPECT_FALSE(report.bound);
}

TEST_F(Claims, OneThatFailsAgainAndAgainIsLeftAlone) {
    OutsideSolver solver(detector("echo x >>" + path("starts").string() + "; exit 7"), {.patience = kShort});
    RldReport report;
    for (int i = 0; i < 8; ++i) report = solver.solve(problem_, {.limits = {.time_limit_ms = 500.0}});
    EXPECT_THAT(report.message, AllOf(HasSubstr("not asked"), HasSubstr("exit code 7")));
    EXPECT_EQ(text_of(path("starts")), "x\nx\nx\nx\n");
}

TEST_F(Claims, AStartIsKeptWhateverHappens) {
    const LaneGraph lane = *make_path_pair_solver()->solve(problem_, {}).lane_graph;
    OutsideSolver solver(detector("exit 7"), {.patience = kShort});
    const RldReport report = solver.solve(problem_, {.limits = {.time_limit_ms = 500.0}, .start = &lane});
    EXPECT_EQ(report.status, SolveStatus::error);
    EXPECT_TRUE(report.lane_graph);
    EXPECT_FALSE(report.bound);
}

/// The program gets its limits and the requested options.
TEST_F(Claims, TheQuestionNamesLimitGapThreadsAndSeed) {
    OutsideSolver solver(detector("SOLVER_LOG=" + path("log").string() + " " + child()), {.threads = 3});
    EXPECT_EQ(solver.solve(problem_, {.limits = {.time_limit_ms = 5000.0, .absolute_gap = 1e-7}, .seed = 41})
                  .status,
              SolveStatus::optimal);
    solver.end();
    EXPECT_THAT(text_of(path("log")), AllOf(HasSubstr(R"("time_limit_ms":49)"), HasSubstr(R"("threads":3)"),
                                            HasSubstr(R"("absolute_gap":1e-07)"), HasSubstr(R"("seed":41)")));
    OutsideSolver once(detector("echo {limit_s} {limit_whole_s} {gap} {threads} {seed} {cutoff} >" +
                                path("told").string() + "; " + child("once {mps} {sol}")),
                       {});
    EXPECT_EQ(once.solve(problem_, {.limits = {.absolute_gap = 1e-7}}).status, SolveStatus::optimal);
    EXPECT_EQ(text_of(path("told")), "1000000.000 1000000 1e-07 1 0 1e+300\n");
}

TEST(OutsideSolverText, HasANameACommandAndPerhapsAFormulation) {
    const auto method = parse_outside_detector("solver:a/paper=run {mps} {sol}");
    ASSERT_TRUE(method);
    EXPECT_TRUE(method->is_solver());
    EXPECT_EQ(method->name, "a");
    EXPECT_EQ(method->formulation, Formulation::paper);
    EXPECT_THROW((void)parse_outside_detector("solver:a/loose=b"), InvalidInput);
    const auto plain = parse_outside_solver("exec:a=run --with b/c=d");
    ASSERT_TRUE(plain);
    EXPECT_EQ(plain->name, "a");
    EXPECT_EQ(plain->source, "run --with b/c=d");
    EXPECT_FALSE(plain->formulation);
    const auto paper = parse_outside_solver("exec:a/paper=run {mps} {sol}");
    ASSERT_TRUE(paper);
    EXPECT_EQ(paper->name, "a");
    EXPECT_EQ(paper->source, "run {mps} {sol}");
    EXPECT_EQ(paper->formulation, Formulation::paper);
    EXPECT_FALSE(parse_outside_solver("path-pair"));
    for (const char* bad : {"exec:a", "exec:a=", "exec:=b", "exec:a/loose=b", "exec:a b=c"})
        EXPECT_THROW((void)parse_outside_solver(bad), InvalidInput) << bad;
    EXPECT_THROW(SolverProgram("run {mps} {sool}"), InvalidInput);
    EXPECT_THROW(SolverProgram("run {mps} {lp}"), InvalidInput);
    EXPECT_NO_THROW(SolverProgram("x=${y}; awk '{ print }' {mps} >{sol}"));
}

}  // namespace
}  // namespace conelane
