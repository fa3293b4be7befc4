#pragma once

#include "evaluation/formats/program_solution.hpp"
#include "evaluation/outside/child_process.hpp"

#include <memory>

namespace conelane {

/// Limits for waiting for a solver's program, beyond the limit that it was told [ms].
struct SolverPatience {
    double late_ms = 1000.0;  ///< until it is killed
    double start_ms =
        20000.0;  ///< added for the first answer of a program that stays: interpreters load packages
    double end_ms = 1000.0;  ///< from the end of its input to its own end
    /// After this many failures in a row, or failures of this duration, a program is not asked again.
    int failures = 10;
    double lost_ms = 60000.0;
};

/// What a solver's program gets in addition to the program to solve.
struct SolverQuestion {
    double time_limit_ms = std::numeric_limits<double>::infinity();
    double absolute_gap = 1e-9;
    unsigned threads = 1;
    std::uint64_t seed = 0;
    std::optional<double> cutoff{};  ///< only points with a lower objective are needed
};

/// A program of others that solves binary programs (docs/from-outside.md). COMMAND is run by
/// `/bin/sh -c`:
/// - where it has {mps} or {lp}, once for each program, with its placeholders replaced: {mps} or {lp} (the
///   program's file), {sol} (the solution file to write), {limit_s}, {limit_whole_s} (rounded up),
///   {limit_ms}, {gap}, {threads}, {seed}, {cutoff} (1e300 for none);
/// - otherwise it is started once and reads one JSON object a line: program, solution (files), time_limit_ms,
///   absolute_gap, threads, seed, cutoff; it answers each by a line: an object with any of status (as in
///   =status=, or error), message, bound, nodes, ms and solver, which go before what the solution file says.
///
/// For any behaviour of the program, no call waits longer than its limit and the patience, and all processes
/// that it started are killed. Its files are in a folder of their own, which is removed with the object or
/// when a signal ends this program.
class SolverProgram {
  public:
    /// Throws InvalidInput if the command has an unknown placeholder, or both {mps} and {lp}.
    static void require_valid_command(std::string_view command);

    /// Throws std::filesystem::filesystem_error if there is no folder for temporary files, InvalidInput if
    /// its name has characters that a shell would interpret or the command is not valid.
    explicit SolverProgram(std::string command, const SolverPatience& patience = {});
    ~SolverProgram();
    SolverProgram(const SolverProgram&) = delete;
    SolverProgram& operator=(const SolverProgram&) = delete;

    struct Answer {
        SolutionFile solution;
        std::string fault;  ///< what went wrong, in words; the other members are then unknown
    };
    [[nodiscard]] Answer solve(const BinaryProgram& program, const SolverQuestion& question);

    /// Ends a conversation.
    void end();
    /// The largest resident memory of any of its processes that have ended [bytes].
    [[nodiscard]] std::size_t peak_bytes() const { return peak_bytes_; }

  private:
    [[nodiscard]] std::string run_once(const SolverQuestion& question);
    [[nodiscard]] std::string converse(const SolverQuestion& question, SolutionFile& told,
                                       bool& needs_no_file);
    void forget_child();
    [[nodiscard]] std::string file(const char* ending) const;

    std::string command_;
    SolverPatience patience_;
    bool is_conversation_;
    bool writes_lp_;
    std::filesystem::path folder_;
    std::optional<ClearOnInterruption> clearing_;
    std::unique_ptr<ChildProcess> child_;
    std::size_t peak_bytes_ = 0;
    int failures_ = 0;
    double lost_ms_ = 0.0;
    std::string last_fault_;
};

}  // namespace conelane
