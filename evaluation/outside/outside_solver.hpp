#pragma once

#include "conelane/formulation.hpp"
#include "conelane/rld_solver.hpp"
#include "evaluation/outside/outside_detector.hpp"
#include "evaluation/outside/solver_program.hpp"
#include "model/binary_program.hpp"
#include "model/lane_graph_model.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace conelane {

/// A program with rows and columns in another order. It is the same program with the same labels; a solver
/// may treat it differently.
struct PermutedProgram {
    BinaryProgram program;
    std::vector<std::size_t> column_of;  ///< the position in `program` of each column of the first program

    /// The point of the first program for a point of `program`. Empty for an empty point.
    [[nodiscard]] std::vector<double> point_of(std::span<const double> point) const;
};

/// Random orders of rows and columns; the entries of a row follow the new order of columns. The same seed
/// gives the same order on any machine.
[[nodiscard]] PermutedProgram permuted(const BinaryProgram& program, std::uint64_t seed);

struct OutsideSolverOptions {
    Formulation formulation = Formulation::tight;
    /// Makes each program complete (add_connecting_flow) and asks once. Otherwise the rows that an answer
    /// violates are added, and the program is asked again within the time limit.
    bool all_rows = false;
    unsigned threads = 1;  ///< told to the program
    SolverPatience patience{};
};

/// A program from outside as an RLD solver. Nothing that it says is trusted. Status error follows from a
/// point that is not integral or violates a row, a wrong objective, a bound above a known lane graph, a proof
/// of infeasibility that the start refutes, a crash, a missed limit and invalid output. An optimum with a gap
/// above the requested one counts as feasible. A wrong optimum can only be found by comparison with another
/// solver. With a seed, rows and columns are in an order drawn from it, and the program also gets the seed.
class OutsideSolver : public RldSolver {
  public:
    /// Precondition: the detector has a command. Throws as SolverProgram does.
    OutsideSolver(const OutsideDetector& detector, const OutsideSolverOptions& options);

    [[nodiscard]] EdgeExtent extent() const override { return parts(options_.formulation).extent; }

    /// The solver's name and version, as the program reports it for the last solve.
    [[nodiscard]] const std::string& version() const { return version_; }  ///< empty if it reports none
    [[nodiscard]] std::optional<double> engine_ms() const { return engine_ms_; }  ///< sum over all rounds
    /// Ends the program.
    void end() { program_.end(); }
    /// See SolverProgram::peak_bytes.
    [[nodiscard]] std::size_t peak_bytes() const { return program_.peak_bytes(); }

  private:
    void run(const LaneGraphProblem& problem, const SolveArguments& arguments, RldReport& report) override;
    void solve_and_separate(const LaneGraphProblem& problem, BinaryProgram& program, double absolute_gap,
                            std::uint64_t seed, const Deadline& deadline, RldReport& report);
    [[nodiscard]] SolverProgram::Answer ask(const BinaryProgram& program, const SolverQuestion& question);

    SolverProgram program_;
    OutsideSolverOptions options_;
    std::string version_;
    std::optional<double> engine_ms_;
    LaneGraphModel model_;
};

}  // namespace conelane
