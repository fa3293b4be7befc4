#pragma once

#include "experiments/options/command_line.hpp"
#include "experiments/studies/backend.hpp"
#include "experiments/studies/study.hpp"

/// Backends on cone sets: a row for each solve. Studies of solvers are aggregations of these rows.
namespace conelane::experiments {

/// A size that means all cones of the scene.
inline constexpr std::size_t kAllVisible = 0;
/// "12", or "all" for kAllVisible.
[[nodiscard]] std::string size_name(std::size_t size);
/// The nearest cones ahead, or all.
[[nodiscard]] Scene cones_of(const AnnotatedScene& scene, std::size_t size);
/// Whether so many cones are ahead.
[[nodiscard]] bool has_cones(const AnnotatedScene& scene, std::size_t size);

/// Objectives that differ by at most this are equal: the possible error of a solver's answer, see
/// SolveLimits.
inline constexpr double kObjectiveTolerance = 1e-6;
/// (objective - optimum) / max(1, |optimum|), at least 0.
[[nodiscard]] double relative_gap(double objective, double optimum);
/// A bound in a file: none below everything.
[[nodiscard]] FieldValue bound_value(const std::optional<double>& bound);

class StoredRows;

struct SolveOptions {
    std::vector<Backend> backends = {};
    std::vector<std::size_t> sizes = {};  ///< may contain kAllVisible
    RldParameters parameters = {};
    double time_limit_ms = 1000.0;          ///< of a solve
    std::vector<double> then_ms = {};       ///< longer limits, ascending, each for what the one before leaves
    const StoredRows* stored = nullptr;     ///< solves that are done; not with a warm start
    std::optional<std::size_t> limit = {};  ///< scenes of each size at most, evenly spread; all if absent
    /// The scenes of a size; empty: those that have enough cones.
    std::function<bool(const AnnotatedScene& scene, std::size_t size)> wanted = {};
    bool with_machine = false;  ///< blocks have memory and the time of the reference problem
    /// Number of additional runs of each scene without a start, with its cones, and rows and columns of the
    /// program (see BackendSolver), in other orders.
    std::size_t permutations = 0;
    std::uint64_t seed = 1;  ///< of the permutations
    /// Limits below the time limit under which each scene is solved again without a start, ascending: for the
    /// gap over time [ms].
    std::vector<double> gap_limits_ms = {};

    [[nodiscard]] double longest_limit_ms() const { return then_ms.empty() ? time_limit_ms : then_ms.back(); }
};

/// One solve.
struct SolveRow {
    const AnnotatedScene* scene = nullptr;
    std::size_t size = 0;  ///< the requested one, or kAllVisible
    std::size_t cones = 0;
    std::size_t permutation = 0;  ///< 0: original order
    std::string scene_hash = {};  ///< of pose and cones, as text; empty in rows of version 0.5
    Backend backend = {};
    SolveStatus status = SolveStatus::error;  ///< also error if the independent checker objects
    std::string message = {};
    std::optional<LaneGraph> lane_graph = {};
    std::optional<double> objective = {};
    std::optional<double> bound = {};
    std::optional<StopReason> stopped_by = {};
    std::int64_t nodes = 0;
    int rounds = 0;         ///< number of times the program was solved
    std::size_t edges = 0;  ///< that (27) allows
    double build_ms = 0.0;
    double limit_ms = 0.0;                 ///< that it was solved under
    double latency_ms = 0.0;               ///< wall clock from the scene to the answer
    double cpu_ms = 0.0;                   ///< processor time of the thread in that
    std::optional<double> engine_ms = {};  ///< measured by the solver itself
    /// A claim that the checked lane graph of another backend on the same cones contradicts: `message` names
    /// it. The status remains the claimed one.
    bool refuted = false;
    std::vector<Knowledge> steps = {};  ///< by the limits for the gap, and at the end

    [[nodiscard]] std::string size_text() const { return size_name(size); }
    /// The optimum, or that there is no lane graph.
    [[nodiscard]] bool is_proven() const {
        return status == SolveStatus::optimal || status == SolveStatus::infeasible;
    }
    [[nodiscard]] bool is_optimal() const { return status == SolveStatus::optimal; }
    [[nodiscard]] bool is_infeasible() const { return status == SolveStatus::infeasible; }
};

/// All solves of one backend at one size.
struct SolveBlock {
    std::size_t size = 0;
    std::string backend;
    std::string version;
    std::string treatment;      ///< Backend::treatment
    double reference_ms = 0.0;  ///< ReferenceProblem just before
    /// Growth of this process, or the largest process of a program from outside.
    std::optional<std::size_t> peak_bytes = {};
};

/// Solves that earlier runs of `conelane study backends` wrote, and their blocks.
class StoredRows {
  public:
    /// Throws InputError naming file, line and key, also for a solve with parameters of another hash.
    StoredRows(const std::vector<std::string>& files, const std::string& parameter_hash);

    /// The stored solve of the run that `wanted` names by scene, its hash, cones, size, backend and
    /// permutation, if it is a proof or had at least the limit of `wanted`; of several the one with the
    /// longest limit. A refuted one stays refuted.
    [[nodiscard]] std::optional<SolveRow> find(const SolveRow& wanted) const;
    [[nodiscard]] const std::vector<SolveBlock>& blocks() const { return blocks_; }

  private:
    /// Backend, scene, size, cones and permutation.
    using Key = std::tuple<std::string, std::string, std::size_t, std::size_t, std::size_t>;
    std::map<Key, SolveRow> rows_;
    std::vector<SolveBlock> blocks_;
};

struct SolveResults {
    std::vector<SolveRow> rows;  ///< by size, backend, scene and permutation
    std::vector<SolveBlock> blocks;
};

/// Lap by lap in one pinned thread. Backends whose solver does not take a size (see Backend::takes) are left
/// out there. Throws InvalidInput if a backend's solver is not in this build.
[[nodiscard]] SolveResults solve_scenes(std::span<const AnnotatedScene> scenes, const SolveOptions& options);

/// The rows of scenes that have to be solved: throws InvalidInput naming the scene of the first error.
[[nodiscard]] std::vector<SolveRow> solved_scenes(std::span<const AnnotatedScene> scenes,
                                                  const SolveOptions& options);

/// Marks each claim that a checked lane graph of another row of the same scene and size refutes by more than
/// kObjectiveTolerance, relative to its size if that is above 1: an optimum or a bound above it, or
/// infeasibility.
void mark_refuted_claims(std::span<SolveRow> rows);

/// The answers by backend and size, and the errors among them; a refuted claim is one.
[[nodiscard]] AnswerErrors errors_among(std::span<const SolveRow> rows);

/// A study that solves the scenes of a file: the options that such studies have in common. `solves` are the
/// defaults; without sizes there, the study has no --sizes, with a time limit of 0 no --time-limit.
class SolveStudy : public SceneStudy {
  public:
    SolveStudy(const StudyDescription& description, SolveOptions solves);
    void add_options(CLI::App& command) override;
    [[nodiscard]] StudyResult measure(const SceneSet& set) final;

  protected:
    /// With the options that were given.
    [[nodiscard]] virtual StudyResult aggregate(const SceneSet& set, SolveOptions solves) = 0;

    SolveOptions solves_;

  private:
    std::vector<std::string> sizes_;
    ParameterSource parameters_;
};

/// Reads "--limit N" into `limit`.
void add_limit_option(CLI::App& command, std::optional<std::size_t>& limit, const std::string& description);
/// Reads time limits [ms] that ascend; `require_ascending` throws InvalidInput where they do not.
CLI::Option* add_limits_option(CLI::App& command, const std::string& name, std::vector<double>& limits_ms,
                               const std::string& description);
void require_ascending(const std::string& name, const std::vector<double>& limits_ms);

/// Scene and track, then the other fields of a row.
template <typename Row>
[[nodiscard]] RowFields<Row> with_scene(const RowFields<Row>& others) {
    RowFields<Row> fields{{"scene", [](const Row& row) { return row.scene->scene.id; }},
                          {"track", [](const Row& row) { return row.scene->track; }}};
    fields.insert(fields.end(), others.begin(), others.end());
    return fields;
}

}  // namespace conelane::experiments
