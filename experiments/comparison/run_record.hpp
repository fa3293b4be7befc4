#pragma once

#include "evaluation/formats/folder_lock.hpp"
#include "evaluation/formats/scene_set.hpp"
#include "evaluation/world/scene_generation.hpp"
#include "experiments/comparison/runner.hpp"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace conelane::experiments {

/// Everything that the answers of a comparison depend on, and whether they may replace others.
struct ComparisonOptions {
    std::vector<std::string> tracks;  ///< SPECs of load_tracks
    std::vector<Method> methods;
    SceneOptions scenes;
    RunOptions run;
    Shard shard;
    bool overwrite = false;  ///< whether results of another run in the directory are replaced
    /// Preparation of the methods, called once the directory is locked and ready.
    std::function<void()> prepare = {};
    std::string cross_validation = {};  ///< JSON object: what the folds depend on; empty without folds
};

/// The options, and commit, compiler and machine of this program, as a JSON object in one line. If the commit
/// does not identify the program (changed sources, or no commit), a hash of the program is added. A method
/// from outside is recorded with its command, or with its file and a hash of it, and with its card. Throws
/// InputError if that file cannot be read.
[[nodiscard]] std::string run_record(const ComparisonOptions& options);

/// Prepares the directory for a run and locks it. If its run.json holds the same record, existing
/// answers stay. If it holds results of another run, these are removed with `overwrite`; otherwise
/// nothing is changed and InputError is thrown. Throws InputError also if another process is writing
/// there.
[[nodiscard]] FolderLock open_run(const std::filesystem::path& directory, const std::string& record,
                                  bool overwrite);

/// The content of run.json of a directory. Throws InputError.
[[nodiscard]] std::string read_run_record(const std::filesystem::path& directory);

}  // namespace conelane::experiments
