// Programs as MPS and LP files: other solvers find the same results in them as our backends.

#include "evaluation/formats/program_files.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/formats/program_solution.hpp"
#include "model/lane_graph_model.hpp"
#include "solvers/milp/milp_solver.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/small_program.hpp"

#include <unistd.h>

namespace conelane {
namespace {

using tests::small_program;

TEST(ProgramFiles, MpsMarksIntegersAndWritesRanges) {
    std::ostringstream out;
    write_mps(out, small_program(), "small");
    EXPECT_EQ(out.str(), R"(NAME small FREE
ROWS
 N cost
 L one_of
 L close_0
COLUMNS
 MARKER 'MARKER' 'INTORG'
 x cost 1
 x one_of 1
 y_1 cost -2
 y_1 one_of 1
 y_1 close_0 1
 MARKER 'MARKER' 'INTEND'
 z_1_2 cost 0
 z_1_2 close_0 -1
RHS
 rhs one_of 1
 rhs close_0 0.5
RANGES
 range close_0 0.5
BOUNDS
 LO bound x 0
 UP bound x 1
 LO bound y_1 0
 UP bound y_1 1
 LO bound z_1_2 0
 UP bound z_1_2 0.75
ENDATA
)");
}

TEST(ProgramFiles, LpListsBinaries) {
    std::ostringstream out;
    write_lp(out, small_program(), "small");
    EXPECT_EQ(out.str(), R"(\ small
Minimize
 cost: + 1 x - 2 y_1 + 0 z_1_2
Subject To
 one_of: + 1 x + 1 y_1 <= 1
 close_0_low: + 1 y_1 - 1 z_1_2 >= 0
 close_0_high: + 1 y_1 - 1 z_1_2 <= 0.5
Bounds
 0 <= z_1_2 <= 0.75
Binaries
 x
 y_1
End
)");
}

TEST(ProgramFiles, NamesMustBeUnique) {
    BinaryProgram program = small_program();
    program.add_column({"y", {1}}, 0.0, true);
    std::ostringstream out;
    EXPECT_THROW(write_mps(out, program, "twice"), InvalidInput);
    EXPECT_THROW(write_lp(out, {}, "empty"), InvalidInput);
}

SolutionFile read(const std::string& text) {
    std::istringstream in(text);
    return read_solution_file(in, small_program());
}

struct Written {
    std::string text;
    SolutionFile::Status status;
    std::optional<double> objective;
    std::vector<double> point;  ///< empty: there is none
};

void expect_read(const std::vector<Written>& all) {
    for (const Written& written : all) {
        SCOPED_TRACE(written.text);
        const SolutionFile solution = read(written.text);
        EXPECT_EQ(solution.status, written.status);
        EXPECT_EQ(solution.objective, written.objective);
        EXPECT_EQ(solution.point, written.point);
    }
}

using Status = SolutionFile::Status;
const std::vector<double> kBest{0.0, 1.0, 0.5};
const std::vector<double> kHalf{0.0, 1.0, 0.0};
const std::vector<double> kZero(3, 0.0);

TEST(SolutionFiles, ByCbc) {
    expect_read({
        {"Optimal - objective value -2.00000000\n      1 y_1    1    -2\n**    2 z_1_2    0.5    0\n",
         Status::optimal, -2.0, kBest},
        {"Infeasible - objective value 0\n", Status::infeasible, {}, {}},
        // With `printingOptions all`, rows come first.
        {"Optimal - objective value -2\n 0 one_of 1 0\n 1 close_0 0.5 0\n 0 x 0 1\n 1 y_1 1 -2\n"
         " 2 z_1_2 0.5 0\n",
         Status::optimal, -2.0, kBest},
        {"Optimal (within gap tolerance) - objective value -2\n 1 y_1 1 -2\n", Status::feasible, -2.0, kHalf},
        // The values below such a first line belong to the relaxation: they are not an incumbent.
        {"Stopped on time (no integer solution - continuous used) - objective value -2.5\n 0 x 0.5 1\n",
         Status::unknown,
         {},
         {}},
        {"Stopped on time - objective value -2\n 1 y_1 1 -2\n", Status::feasible, -2.0, kHalf},
    });
}

TEST(SolutionFiles, ByGlpsolHighsAndScip) {
    expect_read({
        {"c Problem: small\nc\ns mip 2 3 o -2\ni 1 1\ni 2 0.5\nj 1 0\nj 2 1\nj 3 0.5\ne o f\n",
         Status::optimal, -2.0, kBest},
        {"s mip 2 3 n 0\ne o f\n", Status::infeasible, {}, {}},
        {"Model status\nOptimal\n\n# Primal solution values\nFeasible\nObjective -2\n# Columns 3\nx 0\ny_1 "
         "1\n"
         "z_1_2 0.5\n# Rows 2\none_of 1\nclose_0 0.5\n\n# Dual solution values\nNone\n\n# Basis\nHiGHS "
         "v1\nNone\n",
         Status::optimal, -2.0, kBest},
        {"Model status\nInfeasible\n\n# Primal solution values\nNone\n\n# Dual solution values\nNone\n",
         Status::infeasible,
         {},
         {}},
        {"Model status\nTime limit reached\n\n# Primal solution values\nFeasible\nObjective 0\n# Columns "
         "3\nx 0\n",
         Status::feasible, 0.0, kZero},
        {"Model status\nTime limit reached\n\n# Primal solution values\nNone\n", Status::unknown, {}, {}},
        {"solution status: optimal solution found\nobjective value:                 -2\n"
         "y_1                      1 \t(obj:-2)\nz_1_2                  0.5 \t(obj:0)\n",
         Status::optimal, -2.0, kBest},
        {"solution status: infeasible\nno solution available\n", Status::infeasible, {}, {}},
        {"solution status: time limit reached\nno solution available\n", Status::unknown, {}, {}},
        {"solution status: time limit reached\nobjective value: 0\n", Status::feasible, 0.0, kZero},
    });
}

TEST(SolutionFiles, OfMiplibAndGurobi) {
    expect_read({
        {"=obj= -2\ny_1 1\nz_1_2 0.5\n", Status::feasible, -2.0, kBest},
        {"y_1 1\nz_1_2 0.5\n", Status::feasible, {}, kBest},
        {"=infeas=\n", Status::infeasible, {}, {}},
        {"=obj= 0\n", Status::feasible, 0.0, kZero},
        {"# Solution for model small\r\n# Objective value = -2\r\nx 0\r\ny_1 1\r\nz_1_2 0.5\r\n",
         Status::feasible, -2.0, kBest},
    });
}

/// Values that a format does not have may be in lines =KEY= of any format, also after its last line.
TEST(SolutionFiles, RemarksGiveValuesThatAFormatLacks) {
    const SolutionFile gurobi = read(
        "# Objective value = -2\ny_1 1\nz_1_2 0.5\n=status= optimal\n=bound= -2.25\n"
        "=nodes= 12\n=ms= 3.5\n=solver= Gurobi 11.0\n");
    EXPECT_EQ(gurobi.status, SolutionFile::Status::optimal);
    EXPECT_EQ(*gurobi.bound, -2.25);
    EXPECT_EQ(*gurobi.nodes, 12);
    EXPECT_EQ(*gurobi.engine_ms, 3.5);
    EXPECT_EQ(gurobi.solver, "Gurobi 11.0");
    const SolutionFile glpsol =
        read("=solver= GLPK 5.0\ns mip 2 3 f -2\nj 2 1\nj 3 0.5\ne o f\n=bound= -3\n");
    EXPECT_EQ(glpsol.status, SolutionFile::Status::feasible);
    EXPECT_EQ(*glpsol.bound, -3.0);
    EXPECT_EQ(glpsol.solver, "GLPK 5.0");
    EXPECT_EQ(read("=status= unknown\n=bound= -3\n").bound, -3.0);
}

struct RoundTrip {
    std::string program;  ///< the program that must be installed
    std::string ending;
    std::string command;  ///< IN and OUT are replaced by the files
    friend void PrintTo(const RoundTrip& trip, std::ostream* out) { *out << trip.program << trip.ending; }
};

class RoundTrips : public testing::TestWithParam<RoundTrip> {};

bool is_installed(const std::string& program) {
    return std::system(("command -v " + program + " >/dev/null 2>&1").c_str()) == 0;
}

void replace(std::string& text, const std::string& what, const std::string& by) {
    text.replace(text.find(what), what.size(), by);
}

/// Rows that are added on demand are not in a file, so programs are compared, not lanes.
TEST_P(RoundTrips, OtherProgramsFindTheSameOptimum) {
    if (!is_installed(GetParam().program)) GTEST_SKIP() << GetParam().program << " is not installed";
    const std::filesystem::path stem =
        std::filesystem::temp_directory_path() /
        ("conelane_program_" + GetParam().program + GetParam().ending + std::to_string(getpid()));
    const std::string file = stem.string() + "." + GetParam().ending;
    const std::string solution_file = stem.string() + ".sol";
    int feasible = 0;
    for (std::uint64_t seed = 0; seed < 16; ++seed) {
        for (const Formulation formulation : {Formulation::tight, Formulation::paper}) {
            SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << to_string(formulation));
            const Scene scene = tests::random_scene(seed, 7);
            const LaneGraphProblem problem = make_problem(scene, {}, parts(formulation).extent);
            const LaneGraphModel model(problem, formulation);
            const MilpReport ours = kCbc.load(model.program())->solve({});
            {
                std::ofstream out(file);
                GetParam().ending == "mps" ? write_mps(out, model.program(), "round_trip")
                                           : write_lp(out, model.program(), "round_trip");
            }
            std::filesystem::remove(solution_file);
            std::string command = GetParam().command;
            replace(command, "IN", "'" + file + "'");
            replace(command, "OUT", "'" + solution_file + "'");
            ASSERT_EQ(std::system((command + " >/dev/null 2>&1").c_str()), 0) << command;
            std::ifstream in(solution_file);
            const SolutionFile theirs = read_solution_file(in, model.program());
            EXPECT_EQ(fault_of(theirs, model.program()), "");
            if (ours.status != SolveStatus::optimal) {
                EXPECT_EQ(ours.status, SolveStatus::infeasible);
                EXPECT_NE(theirs.status, SolutionFile::Status::optimal);
                continue;
            }
            ++feasible;
            ASSERT_EQ(theirs.status, SolutionFile::Status::optimal);
            EXPECT_NEAR(*theirs.objective, *ours.bound, 1e-6);
            double recomputed = 0.0;
            for (std::size_t c = 0; c < theirs.point.size(); ++c)
                recomputed += theirs.point[c] * model.program().columns[c].objective;
            EXPECT_NEAR(recomputed, *ours.bound, 1e-5);
        }
    }
    std::filesystem::remove(file);
    std::filesystem::remove(solution_file);
    EXPECT_GT(feasible, 3);
}

INSTANTIATE_TEST_SUITE_P(Programs, RoundTrips,
                         testing::Values(RoundTrip{"cbc", "mps", "cbc IN solve solution OUT"},
                                         RoundTrip{"cbc", "lp", "cbc IN solve solution OUT"},
                                         RoundTrip{"glpsol", "mps", "glpsol --freemps IN --write OUT"},
                                         RoundTrip{"glpsol", "lp", "glpsol --lp IN --write OUT"}),
                         [](const auto& test) { return test.param.program + "_" + test.param.ending; });

}  // namespace
}  // namespace conelane
