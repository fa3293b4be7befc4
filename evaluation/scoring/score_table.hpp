#pragma once

#include "evaluation/scoring/score.hpp"

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace conelane {

/// The key of a row of a score table.
struct ScoreKey {
    std::string detector;
    std::optional<double> false_positive_rate;  ///< absent if the scenes have none
    std::optional<double> range_m;              ///< absent if the scenes have none
    std::optional<std::size_t> nearest = {};    ///< cone-set size; absent if the detector saw all cones
    std::string condition = {};                 ///< empty if the scenes name none

    /// The detector's name in tables: "rld-cbc n=12".
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

/// A table for a terminal, a line for each row and a final newline. Shares in per cent, latencies in ms, "-"
/// for an unknown measure. Below are the published figures of both papers, those of CLC for the
/// false-positive rates of the rows (all rates if the rows have none of the paper's).
[[nodiscard]] std::string score_table(std::span<const ScoreRow> rows);

/// One row as a JSON object. Shares in [0, 1], latencies in ms; an unknown measure has no key. The caller
/// adds the provenance.
[[nodiscard]] nlohmann::ordered_json summary_json(const ScoreRow& row);

}  // namespace conelane
