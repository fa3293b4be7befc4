#pragma once

#include "experiments/comparison/echo_floor.hpp"
#include "experiments/files/lane_file.hpp"
#include "experiments/outside/outside_method.hpp"
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

/// The methods from outside among those scored, and what an echo program takes.
struct OutsideMethods {
    std::vector<OutsideMethod> methods;
    EchoFloor echo;
};

/// Writes a line per row: the summary, of a method from outside also `outside` (exec or lanes),
/// `self_timed_ms` and `echo_floor_ms` where they are known and `card`; then commit, compiler and machine of
/// this program, and `run`, a JSON object with everything that the run depended on (options, parameters,
/// seed).
void write_results(const std::filesystem::path& file, std::span<const ScoreRow> rows,
                   std::span<const ScoredRecord> scored, const OutsideMethods& outside,
                   const std::string& run);

/// What a table says below of methods from outside: what its latencies are, how many scenes they failed on,
/// and their cards. Empty where there are none.
[[nodiscard]] std::string outside_notes(std::span<const ScoredRecord> scored, const OutsideMethods& outside);

}  // namespace conelane::experiments
