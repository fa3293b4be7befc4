#pragma once

#include "experiments/files/lane_file.hpp"
#include "experiments/methods.hpp"
#include "experiments/scenes/annotated_scene.hpp"
#include "model/lane.hpp"

#include <span>
#include <vector>

namespace conelane::experiments {

struct RunOptions {
    MethodOptions method;
    DetectionLimits limits;
    /// More than one disturbs the latencies by contention. Laps (runs of scenes of one track, rate and range)
    /// are the unit of work: a detector that carries state sees each lap from its beginning, alone.
    unsigned threads = 1;
    bool show_progress = true;
};

/// Runs a method on every scene and times each call in the same way: from the scene in memory to the lane in
/// memory, on the wall clock. The first scene of each lap is answered once untimed before, so that no latency
/// holds the loading of code; the detector then forgets it. The cut to the cone set is part of the method and
/// of its time. An exception becomes an answer with status error.
[[nodiscard]] std::vector<LaneRecord> run(const MethodEntry& method, std::span<const AnnotatedScene> scenes,
                                          const RunOptions& options);

}  // namespace conelane::experiments
