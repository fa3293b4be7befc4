#pragma once

#include "evaluation/formats/lane_file.hpp"
#include "evaluation/scoring/centre_line_error.hpp"
#include "evaluation/scoring/lane_failure.hpp"
#include "evaluation/scoring/score.hpp"
#include "evaluation/scoring/score_table.hpp"
#include "evaluation/world/annotated_scene.hpp"
#include "experiments/comparison/run_record.hpp"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <ostream>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

namespace conelane::experiments {

/// A record with the scene that it answers and its score. Refers to record and scene.
struct ScoredRecord {
    const AnnotatedScene* scene;
    const LaneRecord* record;
    SceneScore score;
    std::optional<LaneFailure> failure = {};  ///< why the lane is not usable
};

/// The answers of a method, and their scores.
struct ScoredMethod {
    MethodRecord method;
    std::vector<LaneRecord> records;
    std::vector<ScoredRecord> scores = {};  ///< refer to `records`; without scenes that do not count

    /// A row for each condition, rate and range.
    [[nodiscard]] std::vector<ScoreRow> rows() const;
};

/// Scores records against the scenes of one set. Data that all methods share is computed once.
class RecordScorer {
  public:
    /// Scenes and tracks must outlive it.
    RecordScorer(std::span<const AnnotatedScene> scenes, const TrackBoundariesByName& tracks);

    /// Scores in the order of the records, on all processors. The records must cover every scene of the set
    /// once; a scene that does not count is left out. Whether a lane is steady is decided by the record
    /// before, if it is of the same lap. If a method states the objective of its lanes, its status none is a
    /// proof and counts as solved. `lanes_file` is named in errors. Throws InputError, the first one of
    /// several.
    [[nodiscard]] ScoredMethod score(MethodRecord method, std::vector<LaneRecord> records,
                                     const std::filesystem::path& lanes_file) const;

  private:
    struct Truth {
        const AnnotatedScene* scene;
        const TrackBoundaries* boundaries;  ///< null if the tracks file has no track of that name
        bool counts;
        CentreLine centre_line;  ///< empty if the truth is a driven path
    };
    [[nodiscard]] const Truth& truth_of(const LaneRecord& record, const std::filesystem::path& file) const;
    /// Fills in score and failure of `scored`.
    static void score(const Truth& truth, ScoredRecord& scored, CentreLine& line);

    std::size_t scene_count_;
    std::unordered_map<std::string, Truth> truth_of_;  // for look-up only
};

/// The table of all methods, and below it the notes on those from outside.
[[nodiscard]] std::string wide_table(std::span<const ScoredMethod> methods);

/// Writes a line for each record with all its measures.
void write_scores(std::ostream& output, std::span<const ScoredMethod> methods);

/// Writes a line for each row. It has the summary; for a method from outside also `outside` (exec, lanes or
/// solver), `self_timed_ms` if known, and `card`; then commit, compiler and machine of
/// this program, and `run`, a JSON object with everything that the run depended on (options, parameters,
/// seed).
void write_results(std::ostream& output, std::span<const ScoredMethod> methods, const std::string& run);

}  // namespace conelane::experiments
