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
    std::vector<std::optional<std::size_t>> nearest;  ///< cone-set sizes; absent: all visible cones
    RldParameters parameters;
    double time_limit_ms = 10'000.0;  ///< of each engine, for each program
};

/// State of a program's optimum.
struct KnownOptimum {
    enum class Status {
        optimal,     ///< both engines proved `best`
        infeasible,  ///< both engines proved that there is no point
        open,        ///< one of the engines did not finish
    };
    Status status = Status::open;
    std::optional<double> best;   ///< objective of a point; present if optimal
    std::optional<double> bound;  ///< proven lower bound of the program in its file
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

/// A program that can be solved by itself.
struct Instance {
    std::string name;
    BinaryProgram program;
    KnownOptimum optimum;
};

/// The program of a scene with rows of no cycles (5) and of the pairing such that its optimum is a lane
/// graph: CBC solves it, and the rows that its point violates are added, until none is violated. So the
/// optimum of the file is that of the scene, which path-pair finds independently, without a program. If CBC
/// does not finish, no rows are added, and `best` is the scene's optimum, while the program may have a lower
/// one. Nothing if there is no program: without columns, or with more entries than kMaxProgramEntries. Throws
/// std::logic_error if the engines contradict each other.
[[nodiscard]] std::optional<Instance> make_instance(const Scene& scene, const std::string& name,
                                                    Formulation formulation, const InstanceOptions& options);

/// The result of writing.
struct InstanceCounts {
    std::size_t written = 0;
    std::size_t optimal = 0;
    std::size_t infeasible = 0;
    std::size_t too_large = 0;  ///< number of programs left out
};

/// Writes NAME.printed.mps.gz and NAME.tight.mps.gz for each of the scenes into the folder, then
/// conelane.test, the list of these files, and conelane.solu: `=opt= NAME VALUE`, `=inf= NAME`, or for an
/// open optimum `=best= NAME VALUE` and `=bestdual= NAME VALUE`, as far as they are known. The same scenes
/// give the same files, except open ones, which depend on the clock. `advance` is called after each program.
/// A library in the folder is replaced when all files of the new one are complete; until then it stays.
/// Throws InputError, also if the folder holds a program that no list names, or another process writes there.
[[nodiscard]] InstanceCounts write_instances(const std::filesystem::path& folder,
                                             std::span<const InstanceScene> scenes,
                                             const InstanceOptions& options,
                                             const std::function<void()>& advance = {});

}  // namespace conelane::experiments
