#pragma once

#include "experiments/files/lane_file.hpp"
#include "experiments/scenes/annotated_scene.hpp"
#include "experiments/scoring/score_table.hpp"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace conelane::experiments {

/// Scores records against their scenes, in the order of the records. Every record's scene must be in
/// `scenes`, and the records of one method must cover every scene once; a scene that counts nowhere (no
/// ground truth) is left out. `lanes_file` and `scenes_file` name the files in errors. Throws InputError.
[[nodiscard]] std::vector<KeyedScore> score_records(std::span<const AnnotatedScene> scenes,
                                                    const TrackBoundariesByName& tracks,
                                                    std::span<const LaneRecord> records,
                                                    const std::filesystem::path& lanes_file);

/// Writes a line per row: the summary, then commit, compiler, machine, and `run`, a JSON object with
/// everything the run depended on (options, parameters, seed).
void write_results(const std::filesystem::path& file, std::span<const ScoreRow> rows, const std::string& run);

}  // namespace conelane::experiments
