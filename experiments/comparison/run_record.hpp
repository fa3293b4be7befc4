#pragma once

#include "experiments/comparison/runner.hpp"
#include "experiments/scenes/scene_generation.hpp"
#include "experiments/scenes/scene_set.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace conelane::experiments {

/// A method, and the cone-set size it gets instead of its own.
struct Entrant {
    std::string method;
    std::optional<std::size_t> nearest = {};

    /// Name of its lanes file: METHOD.lanes.jsonl or METHOD.n012.lanes.jsonl.
    [[nodiscard]] std::string lanes_file() const;
};

/// All that the answers of a comparison depend on.
struct ComparisonOptions {
    std::vector<std::string> tracks;  ///< SPECs of load_tracks
    std::vector<Entrant> entrants;
    SceneOptions scenes;
    RunOptions run;
    Shard shard;
};

/// The options, and commit, compiler and machine of this program, as a JSON object in one line.
[[nodiscard]] std::string run_record(const ComparisonOptions& options);

/// Makes the directory ready for a run: where its run.json holds the same record, what was answered stays;
/// else files of another run there are removed first. A record of changed sources ("-dirty") is the same as
/// no other. Throws InputError.
void open_run(const std::filesystem::path& directory, const std::string& record);

/// What run.json of a directory holds. Throws InputError.
[[nodiscard]] std::string read_run_record(const std::filesystem::path& directory);

}  // namespace conelane::experiments
