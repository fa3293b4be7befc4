#pragma once

#include "evaluation/scoring/score.hpp"

#include <compare>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace conelane {

/// What a row of a score table is about.
struct ScoreKey {
    std::string detector;
    std::optional<double> false_positive_rate;  ///< absent where the scenes state none
    std::optional<double> range_m;              ///< absent where the scenes state none
    std::optional<std::size_t> nearest = {};    ///< cone-set size; absent where the detector saw all cones
    std::string condition = {};                 ///< empty where the scenes name none

    /// As tables show the detector: "rld-cbc n=12".
    [[nodiscard]] std::string detector_label() const;
    bool operator==(const ScoreKey&) const = default;
};

/// A score with the row it belongs to.
struct KeyedScore {
    ScoreKey key;
    SceneScore score;
};

struct ScoreRow {
    ScoreKey key;
    ScoreSummary summary;
};

/// A row for each key: detectors in the order in which they first appear, within a detector by condition,
/// rate and range, absent ones first; conditions in the order in which they first appear.
[[nodiscard]] std::vector<ScoreRow> summarise_by_key(std::span<const KeyedScore> scores);

/// A table for a terminal, a line per row and a final newline. Shares in per cent, latencies in ms, "-" where
/// a measure is unknown. Below the rows stand the published figures of both papers, those of CLC for the
/// false-positive rates that the rows have (all where they have none of them).
[[nodiscard]] std::string score_table(std::span<const ScoreRow> rows);

/// One row as a JSON object in one line, without newline. Shares in [0, 1], latencies in ms; a measure that
/// is unknown has no key. Provenance is the caller's to add.
[[nodiscard]] std::string summary_json(const ScoreRow& row);

}  // namespace conelane
