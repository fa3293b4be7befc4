#pragma once

#include "experiments/methods.hpp"
#include "experiments/runner.hpp"
#include "experiments/scenes/scene_generation.hpp"
#include "experiments/scoring/score_table.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace conelane::experiments {

struct ComparisonOptions {
    std::vector<std::string> tracks;   ///< SPECs of load_tracks
    std::vector<std::string> methods;  ///< names
    SceneOptions scenes;
    RunOptions run;
    std::filesystem::path directory;
};

/// The main job. Every method on the same scenes, scored in the same way, everything on file in the
/// directory:
///   scenes.scenes.jsonl, scenes.tracks.json  what the methods saw, and the boundaries they are scored
///   against METHOD.lanes.jsonl                       what they answered results.jsonl a line per method,
///   rate and range, with provenance table.txt                                the same for reading
/// Returns the rows of the table. Throws InputError or InvalidInput.
[[nodiscard]] std::vector<ScoreRow> compare(const ComparisonOptions& options);

}  // namespace conelane::experiments
