#pragma once

#include "conelane/formulation.hpp"
#include "conelane/rld_solver.hpp"
#include "evaluation/outside/outside_detector.hpp"
#include "evaluation/outside/solver_program.hpp"
#include "model/lane_graph_model.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace conelane {

struct OutsideSolverOptions {
    Formulation formulation = Formulation::tight;
    /// Makes each program whole (add_connecting_flow) and asks once. Without, the rows that an answer
    /// violates are added, and the program is asked again inside the time limit.
    bool all_rows = false;
    unsigned threads = 1;  ///< told to the program
    SolverPatience patience{};
};

/// A program from outside as an RLD solver. It is trusted in nothing: a point that is not integral or breaks
/// a row, an objective that is not its point's, a bound above a known lane graph, a proof of none that the
/// start refutes give status error, and so do a crash, a missed limit and nonsense. An optimum whose own
/// bound leaves a larger gap than was asked for is a feasible lane graph. What only another solver can
/// refute, a wrong optimum, is for the comparison to find.
class OutsideSolver : public RldSolver {
  public:
    /// Precondition: the detector has a command. Throws as SolverProgram does.
    OutsideSolver(const OutsideDetector& detector, const OutsideSolverOptions& options);

    [[nodiscard]] EdgeExtent extent() const override { return parts(options_.formulation).extent; }

    /// From here on rows and columns stand in an order drawn from the seed, which the program is told too; as
    /// they are with 0, the default.
    void set_seed(std::uint64_t seed) { seed_ = seed; }

    /// What the program says of itself, of the last solve.
    [[nodiscard]] const std::string& version() const { return version_; }  ///< empty where it says nothing
    [[nodiscard]] std::optional<double> engine_ms() const { return engine_ms_; }  ///< all rounds together
    /// Ends the program.
    void end() { program_.end(); }
    /// See SolverProgram::peak_bytes.
    [[nodiscard]] std::size_t peak_bytes() const { return program_.peak_bytes(); }

  private:
    void run(const LaneGraphProblem& problem, const SolveLimits& limits, const LaneGraph* start,
             RldReport& report) override;
    void solve_and_separate(const LaneGraphProblem& problem, BinaryProgram& program,
                            const SolveLimits& limits, const Deadline& deadline, RldReport& report);
    [[nodiscard]] SolverProgram::Answer ask(const BinaryProgram& program, const SolverQuestion& question);

    SolverProgram program_;
    OutsideSolverOptions options_;
    std::uint64_t seed_ = 0;
    std::string version_;
    std::optional<double> engine_ms_;
    LaneGraphModel model_;
};

}  // namespace conelane
