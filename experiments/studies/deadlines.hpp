#pragma once

#include "evaluation/world/annotated_scene.hpp"
#include "experiments/studies/timed_call.hpp"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace conelane::experiments {

class Study;

/// By how much detectors and solvers overrun their time limits.
[[nodiscard]] std::unique_ptr<Study> make_deadlines_study();

struct DeadlineOptions {
    std::vector<double> limits_ms{1.0, 5.0, 20.0, 50.0, 400.0};
    std::size_t repeats = 1;           ///< of each scene under each limit
    std::optional<std::size_t> limit;  ///< largest number of scenes, evenly spread; all if absent
};

/// Quantiles by nearest rank.
struct OverrunStatistics {
    double median_ms = 0.0;
    double p99_ms = 0.0;
    double p999_ms = 0.0;
    double max_ms = 0.0;
};
/// All zero if the sample is empty.
[[nodiscard]] OverrunStatistics overrun_statistics(std::span<const double> overruns_ms);

/// One method under one limit. Statistics are of the calls that were still running when the limit expired.
struct DeadlineRow {
    std::string detector;
    double limit_ms = 0.0;
    std::size_t calls = 0;
    std::size_t struck = 0;         ///< of these, those still running
    OverrunStatistics wall;         ///< wall clock from the limit to the answer
    OverrunStatistics cpu;          ///< the thread's processor time in it: without other programs
    std::string slowest_scene;      ///< of the largest overrun by processor time; empty if there is none
    std::size_t slowest_cones = 0;  ///< number of its cones
};

/// Detector by detector, in the order of the limits. Throws InvalidInput if there is no scene, or if an
/// answer is an error.
[[nodiscard]] std::vector<DeadlineRow> deadline_rows(std::span<const AnnotatedScene> scenes,
                                                     std::span<const TimedCall> calls,
                                                     const DeadlineOptions& options);

[[nodiscard]] std::string deadline_table(std::span<const DeadlineRow> rows);

}  // namespace conelane::experiments
