#pragma once

#include "conelane/formulation.hpp"
#include "conelane/lane_graph_problem.hpp"
#include "evaluation/world/scene_generation.hpp"
#include "model/binary_program.hpp"

#include <array>
#include <functional>

namespace conelane::experiments {

/// Costs and pairing of a program.
struct InstanceObjective {
    std::string costs = "default";  ///< name of the parameters, for people
    RldParameters parameters;

    /// What it adds to the name of a program: nothing for (29) with pairs of near and far ends, else the
    /// costs and "paper".
    [[nodiscard]] std::string suffix() const;
};

/// Which programs, and how long they may be solved.
struct InstanceOptions {
    std::vector<std::string> tracks;
    SceneOptions scenes;
    std::vector<std::optional<std::size_t>> nearest;  ///< cone-set sizes; absent: all visible cones
    std::optional<std::size_t>
        limit;  ///< largest number of scenes of each size, evenly spread; all if absent
    std::vector<InstanceObjective> objectives{{}};  ///< at least one
    std::optional<std::size_t> max_printed_cones;   ///< larger cone sets have the tight program only
    double time_limit_ms = 10'000.0;                ///< of each engine, for each program
};

/// An engine that proved an optimum, or that there is no point.
struct Proof {
    std::string engine;  ///< path-pair, cbc or cbc-main; "cbc-main all rows" on the program with the flow
    double time_ms = 0.0;
};

/// State of a program's optimum.
struct KnownOptimum {
    std::optional<double> best;   ///< objective of a lane graph
    std::optional<double> bound;  ///< highest proven lower bound
    std::vector<Proof> proofs;    ///< at most one by path-pair, then one by CBC

    [[nodiscard]] bool is_by_both() const { return proofs.size() == 2; }
    [[nodiscard]] bool is_optimal() const { return is_by_both() && best; }
    [[nodiscard]] bool is_infeasible() const { return is_by_both() && !best; }
    /// The fastest proof; nullptr without one.
    [[nodiscard]] const Proof* first() const;
};

/// How hard a program is for the best of the engines: easy if one proves its optimum within kEasy_ms, hard if
/// one does within the time limit, else open. It depends on the machine.
enum class InstanceClass { easy, hard, open };
inline constexpr double kEasy_ms = 1000.0;
[[nodiscard]] InstanceClass class_of(const KnownOptimum& optimum);
[[nodiscard]] std::string_view to_string(InstanceClass instance_class);

/// A cone set that programs are made of, and its name, without blanks and slashes.
struct InstanceScene {
    std::string name;
    Scene scene;                         ///< the cone set
    std::optional<std::size_t> nearest;  ///< absent: all visible cones
    std::string track;
    std::string condition;  ///< empty without a named condition
    std::optional<double> false_positive_rate;
    std::optional<double> range_m;
};

/// For every size, the scenes with more cones than that, at most `limit` of them; in the order of the scenes.
[[nodiscard]] std::vector<InstanceScene> instance_scenes(const InstanceOptions& options);

/// How a formulation's files end, before `.mps.gz`: ".printed" or ".tight".
[[nodiscard]] std::string_view ending_of(Formulation formulation);

/// Whether a course is one of those on which path-pair and the parameters of RLD were developed: the FSD
/// courses, all generated ones, and those that the records of `tune` name. All others are held out.
[[nodiscard]] bool is_tuning_course(std::string_view track);

/// A program that can be solved by itself: its optimum is that of the scene.
struct Instance {
    std::string name;
    BinaryProgram program;
    KnownOptimum optimum;
    bool has_flow = false;  ///< all rows, by add_connecting_flow; else those that were separated
};

/// The program of a scene with rows of no cycles (5) and of the pairing such that its optimum is a lane
/// graph. CBC solves it, and the rows that its point violates are added, until none is violated. path-pair
/// finds the optimum independently, without a program. If both find the same, the program has these rows,
/// else all rows by a flow; CBC solves the program with the flow too if it did not finish before. Nothing if
/// there is no program: without columns, or with more entries than kMaxProgramEntries. Throws
/// std::logic_error if the engines contradict each other.
[[nodiscard]] std::optional<Instance> make_instance(const Scene& scene, const std::string& name,
                                                    Formulation formulation, const RldParameters& parameters,
                                                    double time_limit_ms);

/// The result of writing.
struct InstanceCounts {
    std::size_t written = 0;
    std::size_t optimal = 0;
    std::size_t infeasible = 0;
    std::size_t too_large = 0;              ///< number of programs left out
    std::array<std::size_t, 3> of_class{};  ///< by InstanceClass
};

/// Writes NAME.printed.mps.gz and NAME.tight.mps.gz for each scene and objective into the folder, then
/// conelane.test, the list of these files, conelane.solu: `=opt= NAME VALUE`, `=inf= NAME`, or for any
/// other optimum `=best= NAME VALUE` and `=bestdual= NAME VALUE`, as far as they are known, index.csv: a
/// line for each file, with its scene, objective, class, rows and features, and conelane.scenes.jsonl: the
/// cone sets, whose ids are the names without objective and formulation. The same scenes give the same files,
/// except those that an engine does not finish in time, and the classes. `advance` is called after each
/// program. A library in the folder is replaced when all files of the new one are complete; until then it
/// stays. Throws InputError, also if the folder holds a program that no list names, or another process writes
/// there; InvalidInput if two cone sets have one name.
[[nodiscard]] InstanceCounts write_instances(const std::filesystem::path& folder,
                                             std::span<const InstanceScene> scenes,
                                             const InstanceOptions& options,
                                             const std::function<void()>& advance = {});

}  // namespace conelane::experiments
