#pragma once

#include "evaluation/formats/scene_set.hpp"
#include "experiments/comparison/results.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace conelane::experiments {

inline constexpr std::size_t kSummaryColumns = 100;
inline constexpr std::size_t kSummaryLines = 30;
/// The last lines of a command's output: where the files and the page are.
inline constexpr std::size_t kLinesBelowSummary = 3;

/// The summary of a comparison for a terminal, at most kSummaryColumns wide and, with the notes below it,
/// kSummaryLines high. It shows the share of usable lanes for each method, condition and rate of false
/// positives, over all ranges; the latency over all scenes (median and 99th percentile); and why the other
/// lanes are not usable. Methods are sorted by their share of usable lanes in all scenes; equal ones stay in
/// the order of the records.
///
/// If a method has several cone-set sizes, the columns are the sizes, for the lanes that are accurate among
/// these cones, the share proven, the median latency with its growth, and its 95 % quantile. Columns and
/// methods without room are counted; the wide table has them. `notes` are lines without newline, each cut if
/// it is too long. Empty if nothing was scored.
[[nodiscard]] std::string summary(std::span<const ScoredMethod> methods,
                                  const std::vector<std::string>& notes);
/// The same, with notes on methods from outside and on scenes that were left out.
[[nodiscard]] std::string summary(std::span<const ScoredMethod> methods, const LeftOutScenes& left_out);

}  // namespace conelane::experiments
