#pragma once

#include "experiments/files/lane_file.hpp"
#include "experiments/scenes/annotated_scene.hpp"
#include "experiments/scoring/score.hpp"
#include "experiments/scoring/score_table.hpp"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace conelane::experiments {

/// A record, the scene it answers and what that is worth. Refers to both.
struct ScoredRecord {
    const AnnotatedScene* scene;
    const LaneRecord* record;
    SceneScore score;
};

/// Scores records against their scenes, in the order of the records. Every record's scene must be in
/// `scenes`, and the records of one method and cone-set size must cover every scene once; a scene without a
/// ground truth is left out. `lanes_file` is named in errors. Throws InputError.
[[nodiscard]] std::vector<ScoredRecord> score_records(std::span<const AnnotatedScene> scenes,
                                                      const TrackBoundariesByName& tracks,
                                                      std::span<const LaneRecord> records,
                                                      const std::filesystem::path& lanes_file);

/// A row for each method, cone-set size, rate and range.
[[nodiscard]] std::vector<ScoreRow> summarise(std::span<const ScoredRecord> scored);

/// Writes a line per record with every measure of it.
void write_scores(const std::filesystem::path& file, std::span<const ScoredRecord> scored);

/// Writes a line per row: the summary, then commit, compiler and machine of this program, and `run`, a JSON
/// object with everything that the run depended on (options, parameters, seed).
void write_results(const std::filesystem::path& file, std::span<const ScoreRow> rows, const std::string& run);

}  // namespace conelane::experiments
