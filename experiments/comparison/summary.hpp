#pragma once

#include "evaluation/scenes/left_out_scenes.hpp"
#include "experiments/comparison/results.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace conelane::experiments {

inline constexpr std::size_t kSummaryColumns = 100;
inline constexpr std::size_t kSummaryLines = 30;
/// What a command says below the summary: where the files and the page are.
inline constexpr std::size_t kLinesBelowSummary = 3;

/// What a comparison says on a terminal, in at most kSummaryColumns columns and, with what stands below it,
/// kSummaryLines lines: the share of usable lanes for each method, condition and rate of false positives, all
/// ranges together; latency over all scenes (median and 99th percentile); and why the other lanes are not
/// usable. Methods stand best first by their share of usable lanes in all scenes, equal ones in the order of
/// the records.
///
/// Where a method comes with several cone-set sizes these are the columns, for the usable lanes and for the
/// median latency. Columns and methods that have no room are counted, and the wide table has them. `notes`
/// are lines of their own without newline; each is cut where it is too long. Empty where nothing was scored.
[[nodiscard]] std::string summary(std::span<const ScoredRecord> scored,
                                  const std::vector<std::string>& notes = {});

/// What a summary says below: which methods are from outside, and what was left out.
[[nodiscard]] std::vector<std::string> summary_notes(const OutsideDetectors& outside,
                                                     const LeftOutScenes& left_out);

}  // namespace conelane::experiments
