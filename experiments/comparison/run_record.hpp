#pragma once

#include "evaluation/files/folder_lock.hpp"
#include "evaluation/outside/outside_detector.hpp"
#include "evaluation/scenes/scene_generation.hpp"
#include "evaluation/scenes/scene_set.hpp"
#include "experiments/comparison/runner.hpp"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace conelane::experiments {

/// A detector, and the cone-set size it gets instead of its own.
struct ComparedDetector {
    std::string name;  ///< of a detector of this program, or of `outside`
    std::optional<std::size_t> nearest = {};
    std::optional<OutsideDetector> outside = {};
    /// Another way to make the detector, such as from weights that have not seen the course; none: by its
    /// name.
    std::function<DetectorMaker(const RunOptions&)> maker = {};

    /// Name of its lanes file: NAME.lanes.jsonl or NAME.n012.lanes.jsonl.
    [[nodiscard]] std::string lanes_file() const;
};

/// All that the answers of a comparison depend on, and whether they may replace others.
struct ComparisonOptions {
    std::vector<std::string> tracks;  ///< SPECs of load_tracks
    std::vector<ComparedDetector> detectors;
    SceneOptions scenes;
    RunOptions run;
    Shard shard;
    bool overwrite = false;  ///< results of another run in the directory
    /// What is needed before the detectors can be made; called when the directory is locked and ready.
    std::function<void()> prepare = {};
    std::string cross_validation = {};  ///< JSON object, what the folds depend on; empty where there are none
};

/// The detector that a text of `--methods` names. Throws InvalidInput where there is no such detector and
/// where a finished lanes file is to get a cone-set size; InputError where the card of a detector from
/// outside is wrong.
[[nodiscard]] ComparedDetector parse_compared_detector(const std::string& text,
                                                       std::optional<std::size_t> nearest = {});

/// The options, and commit, compiler and machine of this program, as a JSON object in one line. Where the
/// commit does not say which program it is (changed sources, or none known), a hash of the program does. A
/// detector from outside is recorded with its command, or with its file and a hash of it, and with its card.
/// Throws InputError where that file cannot be read.
[[nodiscard]] std::string run_record(const ComparisonOptions& options);

/// Makes the directory ready for a run and keeps others out of it: where its run.json holds the same record,
/// what was answered stays; where it holds results of another run, these are removed with `overwrite`, and
/// without it nothing is touched and InputError thrown. Throws InputError too where another process is
/// writing there.
[[nodiscard]] FolderLock open_run(const std::filesystem::path& directory, const std::string& record,
                                  bool overwrite);

/// What run.json of a directory holds. Throws InputError.
[[nodiscard]] std::string read_run_record(const std::filesystem::path& directory);

}  // namespace conelane::experiments
