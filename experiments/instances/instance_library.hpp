#pragma once

#include "conelane/formulation.hpp"
#include "conelane/rld_parameters.hpp"
#include "evaluation/scenes/scene_generation.hpp"
#include "model/binary_program.hpp"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace conelane::experiments {

/// Which programs, and how long they may be solved.
struct InstanceOptions {
    std::vector<std::string> tracks;
    SceneOptions scenes;
    std::vector<std::optional<std::size_t>> nearest;  ///< cone-set sizes; absent: all that is visible
    RldParameters parameters;
    double time_limit_ms = 10'000.0;  ///< of each engine, for each program
};

/// What is known of a program's optimum.
struct KnownOptimum {
    enum class Status {
        optimal,     ///< both engines proved `best`
        infeasible,  ///< both engines proved that there is no point
        open,        ///< one of them did not come to its end
    };
    Status status = Status::open;
    std::optional<double> best;   ///< objective of a point; there where optimal
    std::optional<double> bound;  ///< proven lower bound of the program as it stands in its file
};

/// A cone set that programs are made of, and its name, without blanks and slashes.
struct InstanceScene {
    std::string name;
    Scene scene;
};

/// Every scene with every size. A size that is not below the scene's number of cones is left out.
[[nodiscard]] std::vector<InstanceScene> instance_scenes(const InstanceOptions& options);

/// How a formulation's files end, before `.mps.gz`: ".printed" or ".tight".
[[nodiscard]] std::string_view ending_of(Formulation formulation);

/// A program that stands for itself.
struct Instance {
    std::string name;
    BinaryProgram program;
    KnownOptimum optimum;
};

/// The program of a scene together with the rows of no cycles (5) and of the pairing that keep its optimum a
/// lane graph: CBC solves it, the rows that its point violates are added, until there are none. So the
/// optimum of the file is that of the scene, which path-pair finds on its own, without a program. Where CBC
/// does not come to its end, no rows are added, and the scene's optimum is `best` of a program that may have
/// a lower one. Nothing where there is no program: it would have no columns, or more entries than
/// kMaxProgramEntries. Throws std::logic_error where the engines contradict each other.
[[nodiscard]] std::optional<Instance> make_instance(const Scene& scene, const std::string& name,
                                                    Formulation formulation, const InstanceOptions& options);

/// What was written.
struct InstanceCounts {
    std::size_t written = 0;
    std::size_t optimal = 0;
    std::size_t infeasible = 0;
    std::size_t too_large = 0;  ///< programs left out
};

/// Writes NAME.printed.mps.gz and NAME.tight.mps.gz for each of the scenes into the folder, then
/// conelane.test, the list of these files, and conelane.solu: `=opt= NAME VALUE`, `=inf= NAME`, or where the
/// optimum is open `=best= NAME VALUE` and `=bestdual= NAME VALUE`, each where it is known. The same scenes
/// give the same files, but for open ones, which depend on the clock. `advance` is called after each program.
/// The library that the folder held is replaced by its list when all files of the new one are whole; until
/// then it stays. Throws InputError, so where the folder holds a program that no list names, or another
/// process writes there.
[[nodiscard]] InstanceCounts write_instances(const std::filesystem::path& folder,
                                             std::span<const InstanceScene> scenes,
                                             const InstanceOptions& options,
                                             const std::function<void()>& advance = {});

}  // namespace conelane::experiments
