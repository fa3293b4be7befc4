#pragma once

#include "experiments/race/race.hpp"

#include <nlohmann/json_fwd.hpp>

namespace conelane::experiments {

/// A race as an entry of a table.
struct Heat {
    std::string course;
    std::string detector;
    double false_positive_rate = 0.0;
    std::uint64_t seed = 0;
    RaceResult result = {};
};

/// A row for each detector and share of false positives, in the order in which they first occur; then, for
/// each course and detector, how far the unfinished races went.
[[nodiscard]] std::string race_table(std::span<const Heat> heats, int laps);

/// How fast and steady the laps were, a row for the first laps and one for the later ones of each detector
/// and share of false positives; of races whose speed follows the trust.
[[nodiscard]] std::string speed_table(std::span<const Heat> heats);

/// Median and 99th percentile of the real time of an answer, by detector. They differ from run to run.
[[nodiscard]] std::string answer_time_table(std::span<const Heat> heats);

[[nodiscard]] nlohmann::ordered_json heat_json(const Heat& heat);
/// The record of a drive: positions of the car, paths and seen points of each frame, rounded to 1 cm.
[[nodiscard]] nlohmann::ordered_json replay_json(const Heat& heat, const RaceCourse& course);

}  // namespace conelane::experiments
