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

/// The cases that a run draws, and how it solves them.
struct CrossCheckOptions {
    std::vector<std::filesystem::path> scenes;  ///< given scenes; may be empty
    std::uint64_t seed = 1;
    std::size_t first = 0;
    std::size_t cases = 1000;
    std::vector<std::string> solvers = exact_solver_names();
    double time_limit_ms = 5'000.0;  ///< the generous limit of each solve
    unsigned threads = 1;
    /// Makes the solvers of a case; if empty, they are made by their names.
    std::function<std::vector<CheckedSolver>(Formulation)> make_solvers = {};
};

/// The content of a folder of cases, and what this run added.
struct CrossCheckSummary {
    std::map<CrossCheckOutcome, std::size_t> outcomes;  ///< of all cases from the first on
    std::size_t cases = 0;
    std::size_t certified = 0;
    std::size_t added = 0;  ///< by this run; the following numbers refer to these cases
    std::size_t tight_answers = 0;
    std::size_t tight_proofs = 0;
    double seconds = 0.0;
};

/// Judges the cases `first` to `first + cases` and writes a line for each to DIRECTORY/cases.jsonl, below a
/// line with what they depend on. A stopped run resumes after its last complete line, and a later run may add
/// cases. If a solver reaches the generous limit, a line depends on the clock; otherwise it depends only on
/// the options, not on the threads. A case that differs is shrunk and written by write_case. Throws
/// InputError if the directory cannot be written, another process writes there, or it holds another run,
/// which then stays unchanged.
[[nodiscard]] CrossCheckSummary cross_check(const CrossCheckOptions& options,
                                            const std::filesystem::path& directory);

/// The result in two lines.
[[nodiscard]] std::string to_text(const CrossCheckSummary& summary);

/// Judges a stored case up to `repetitions` times, until it differs: answers under tight limits
/// vary.
[[nodiscard]] CrossCheckVerdict judge_stored_case(const std::filesystem::path& file, std::size_t repetitions);

}  // namespace conelane::experiments
