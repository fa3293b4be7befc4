#pragma once

#include "experiments/cross_check/drawn_case.hpp"
#include "experiments/cross_check/judge.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace conelane::experiments {

/// What a run draws and asks.
struct CrossCheckOptions {
    std::vector<std::filesystem::path> scenes;  ///< given ones; may be none
    std::uint64_t seed = 1;
    std::size_t first = 0;
    std::size_t cases = 1000;
    std::vector<std::string> solvers = exact_solver_names();
    double time_limit_ms = 5'000.0;  ///< the generous limit of each solve
    unsigned threads = 1;
    /// How the solvers of a case are made; by their names where it is empty.
    std::function<std::vector<CheckedSolver>(Formulation)> make_solvers = {};
};

/// What a folder of cases holds, and what this run added.
struct CrossCheckSummary {
    std::map<CrossCheckOutcome, std::size_t> outcomes;  ///< of all cases from the first on
    std::size_t cases = 0;
    std::size_t certified = 0;
    std::size_t added = 0;  ///< by this run, which the numbers below are of
    std::size_t tight_answers = 0;
    std::size_t tight_proofs = 0;
    double seconds = 0.0;
};

/// Judges the cases `first` to `first + cases` and keeps a line of each in DIRECTORY/cases.jsonl, below one
/// that says what they depend on. A run that was stopped goes on after its last whole line, and more cases
/// may be asked for. Lines depend on the clock where a solver hits the generous limit, otherwise on nothing
/// but the options: not on the threads. A case that differs is shrunk and written by write_case. Throws
/// InputError where the directory cannot be written, another process writes there, or it holds another run:
/// then it stays as it is.
[[nodiscard]] CrossCheckSummary cross_check(const CrossCheckOptions& options,
                                            const std::filesystem::path& directory);

/// Two lines.
[[nodiscard]] std::string to_text(const CrossCheckSummary& summary);

/// Judges a stored case `repetitions` times, as answers under tight limits differ from time to time, or until
/// it differs.
[[nodiscard]] CrossCheckVerdict judge_stored_case(const std::filesystem::path& file, std::size_t repetitions);

}  // namespace conelane::experiments
