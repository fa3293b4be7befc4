#pragma once

#include "conelane/lane_detector.hpp"
#include "experiments/files/lane_file.hpp"
#include "experiments/methods.hpp"
#include "experiments/scenes/annotated_scene.hpp"

#include <cstddef>
#include <functional>
#include <limits>
#include <span>
#include <vector>

namespace conelane::experiments {

struct RunOptions {
    DetectorOptions method;
    DetectionLimits limits{.time_limit_ms = std::numeric_limits<double>::infinity()};
    /// One: on one processor. More disturb the latencies by contention.
    unsigned threads = 1;
    bool show_progress = true;
};

/// First scene of each lap, and the number of scenes at the end. A lap is a run of scenes of one track, rate
/// and range, the unit of work: a detector that carries state sees each lap from its beginning, alone.
[[nodiscard]] std::vector<std::size_t> lap_starts(std::span<const AnnotatedScene> scenes);

/// Gets the records of each lap, in the order of the laps, from one thread at a time.
using LapSink = std::function<void(std::span<const LaneRecord>)>;

/// Runs a method on every scene and times each call in the same way: from the scene in memory to the lane in
/// memory, on the wall clock. The first scene of each lap is answered once untimed before, so that no latency
/// holds the loading of code; the detector then forgets it. The cut to the cone set is part of the method and
/// of its time. An exception becomes an answer with status error, and so does what an RLD method found where
/// the independent checker rejects it (see check_answer; not timed).
void run(const Method& method, std::span<const AnnotatedScene> scenes, const RunOptions& options,
         const LapSink& sink);

/// The same, all records at once.
[[nodiscard]] std::vector<LaneRecord> run(const Method& method, std::span<const AnnotatedScene> scenes,
                                          const RunOptions& options);

}  // namespace conelane::experiments
