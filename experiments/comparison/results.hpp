#pragma once

#include "evaluation/formats/lane_file.hpp"
#include "evaluation/outside/outside_detector.hpp"
#include "evaluation/scoring/centre_line_error.hpp"
#include "evaluation/scoring/lane_failure.hpp"
#include "evaluation/scoring/score.hpp"
#include "evaluation/scoring/score_table.hpp"
#include "evaluation/world/annotated_scene.hpp"
#include "experiments/comparison/echo_floor.hpp"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <ostream>
#include <set>
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

/// Scores records against the scenes of one set. Data that all detectors share is computed once.
class RecordScorer {
  public:
    /// The courses that a detector has learned from.
    using CoursesOf = std::function<std::set<std::string>(const std::string& detector)>;

    /// Scenes and tracks must outlive it.
    RecordScorer(std::span<const AnnotatedScene> scenes, const TrackBoundariesByName& tracks,
                 CoursesOf courses_of);

    /// Scores in the order of the records, on all processors. Every record's scene must belong to the set,
    /// and the records of one detector and cone-set size must cover every scene once; a scene that does not
    /// count is left out. Whether a lane is steady is decided by the record before, if it has the same
    /// detector and lap. If a detector states the objective of its lanes, its status none is a proof and
    /// counts as solved. `lanes_file` is named in errors. Throws InputError, the first one of several.
    [[nodiscard]] std::vector<ScoredRecord> score(std::span<const LaneRecord> records,
                                                  const std::filesystem::path& lanes_file);

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
    CoursesOf courses_of_;
    std::unordered_map<std::string, Truth> truth_of_;  // for look-up only
};

/// A row for each detector, cone-set size, condition, rate and range.
[[nodiscard]] std::vector<ScoreRow> summarise(std::span<const ScoredRecord> scored);

/// Writes a line for each record with all its measures.
void write_scores(std::ostream& output, std::span<const ScoredRecord> scored);

/// The detectors from outside among the scored ones, and the time of an echo program.
struct OutsideDetectors {
    std::vector<OutsideDetector> detectors;
    EchoFloor echo;

    /// The courses that a detector has learned from: those of its card for a detector from outside, none if
    /// it was `cross_validated`, else training_courses.
    [[nodiscard]] std::set<std::string> courses_of(const std::string& detector, bool cross_validated) const;
};

/// Writes a line for each row. It has the summary; for a detector from outside also `outside` (exec, lanes or
/// solver), `self_timed_ms` and `echo_floor_ms` if known, and `card`; then commit, compiler and machine of
/// this program, and `run`, a JSON object with everything that the run depended on (options, parameters,
/// seed).
void write_results(std::ostream& output, std::span<const ScoreRow> rows, std::span<const ScoredRecord> scored,
                   const OutsideDetectors& outside, const std::string& run);

/// The lines below a table about detectors from outside: what their latencies mean, how many scenes they
/// failed on, and their cards. Empty if there are none.
[[nodiscard]] std::string outside_notes(std::span<const ScoredRecord> scored,
                                        const OutsideDetectors& outside);

}  // namespace conelane::experiments
