#pragma once

#include "conelane/formulation.hpp"
#include "conelane/rld_parameters.hpp"
#include "conelane/solve_report.hpp"
#include "evaluation/world/annotated_scene.hpp"

#include <filesystem>
#include <functional>
#include <map>

namespace conelane::experiments {

/// A scene and parameters on which all exact solvers are to agree.
struct CrossCheckCase {
    std::size_t number = 0;
    std::string kind;  ///< one of cross_check_kinds(), or "given"
    Scene scene;       ///< at least one cone
    RldParameters parameters;
    Formulation formulation = Formulation::tight;  ///< of the solvers that use one
    double tight_limit_ms = 1.0;                   ///< time limit of a second solve by each solver
};

/// Kinds of scenes that are made up:
///   lane        a bent lane with false positives
///   strewn      cones strewn at random
///   collinear   all cones on one line or on two parallel ones, evenly spaced
///   lattice     cones at points of a square lattice: ties of every kind
///   coincident  a lane, some of whose cones lie on others or up to 5 cm beside them
///   symmetric   each cone has its mirror image across the car's axis
///   at_limits   a lane, and a parameter that one of its distances, costs or angles meets exactly or nearly
///   far_away    one of the above, 1 km to 10^12 m from the origin
///   scaled      one of the above, 10^-300 to 10^300 times as large, in part with the lengths among the
///   parameters
[[nodiscard]] std::vector<std::string_view> cross_check_kinds();

/// Case `number` of a seed: it depends only on these two and on the given scenes, so a run may be cut into
/// parts. Three of ten cases are the nearest cones of a given scene, if there is one. 1 to 24 cones, mostly 4
/// to 9. Parameters: both pairings, both sets of costs, and in half of the cases any of them drawn from its
/// range.
[[nodiscard]] CrossCheckCase draw_cross_check_case(std::span<const AnnotatedScene> given, std::uint64_t seed,
                                                   std::size_t number);

/// The case with as many cones removed, and as many parameters at their defaults, as `differs` allows: it
/// holds for the result, and not after any further cone is removed. It is called at most `max_trials` times.
/// Precondition: it holds for `drawn`.
[[nodiscard]] CrossCheckCase shrink(CrossCheckCase drawn,
                                    const std::function<bool(const CrossCheckCase&)>& differs,
                                    std::size_t max_trials = 2000);

/// A stored case, to be judged again.
struct StoredCase {
    CrossCheckCase drawn;
    std::vector<std::string> solvers;
    double time_limit_ms = 0.0;  ///< the generous limit
};

/// Writes NAME.scenes.jsonl, NAME.params.json and, if the scene has an edge, NAME.mps, the program in the
/// case's formulation; finally NAME.case.json, which names them and holds the rest and the findings. NAME is
/// the scene's id. Returns its path. Each file appears complete or not at all. Throws InputError.
std::filesystem::path write_case(const std::filesystem::path& directory, const StoredCase& stored,
                                 std::span<const std::string> findings);

/// Reads a NAME.case.json and the files beside it. Throws InputError naming file, line and key.
[[nodiscard]] StoredCase read_case(const std::filesystem::path& file);

/// A solver that claims to be exact, used for one case after another.
struct CheckedSolver {
    std::string name;
    std::function<RldReport(const Scene&, const RldParameters&, const SolveArguments&)> solve;
    std::optional<std::size_t> max_cones = {};  ///< it does not get larger cone sets
    bool takes_starts = false;
};

/// The names of the exact solvers of this build.
[[nodiscard]] std::vector<std::string> exact_solver_names();

/// New solvers of these names. Throws InvalidInput if one is not an exact solver.
[[nodiscard]] std::vector<CheckedSolver> make_checked_solvers(std::span<const std::string> names,
                                                              Formulation formulation);

enum class CrossCheckOutcome {
    same_optimum,  ///< with the generous limit, all have proven the same optimum
    infeasible,    ///< with the generous limit, all have proven that there is no lane graph
    undecided,     ///< no contradiction, but with the generous limit not all have a proof
    differ,        ///< a contradiction or an error, see the findings
};
[[nodiscard]] std::string_view to_string(CrossCheckOutcome outcome);

struct CrossCheckVerdict {
    CrossCheckOutcome outcome = CrossCheckOutcome::undecided;
    std::optional<double> objective;    ///< of the first solver, if it is proven optimal
    std::vector<std::string> findings;  ///< a sentence each
    bool certified = false;             ///< the proof was repeated in rational arithmetic
    std::size_t tight_answers = 0;
    std::size_t tight_proofs = 0;  ///< claims among these of optimal or infeasible that are not refuted
};

/// Runs each solver with the generous limit, then with the case's tight limit, and from starts: its own
/// answer (with both limits); with the tight limit also the answer of another solver, an answer without its
/// last edge, random edges, and an answer with an edge of a cone that is missing. Compares every claim with
/// all others, whatever its solver, limit or start:
/// - each status has the right content: a lane graph only with `optimal` and `feasible`; with `optimal`, a
///   bound equal to the objective;
/// - the independent checker accepts each lane graph and its objective;
/// - an answer from a feasible start is a lane graph that costs no more;
/// - no bound is above any accepted lane graph's objective by more than 1e-6 of max(1, |objective|), so no
///   objective is below what was proven; `infeasible` counts as an infinite bound;
/// - if all say `infeasible`, a search by the checker alone finds no lane graph within 20 ms;
/// - the proof of path-pair, for up to 12 cones, can be repeated in rational arithmetic from the scene alone,
///   within a few thousand steps.
[[nodiscard]] CrossCheckVerdict judge(const CrossCheckCase& drawn, std::span<const CheckedSolver> solvers,
                                      double time_limit_ms);

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
