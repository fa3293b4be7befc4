#pragma once

#include "evaluation/formats/lane_file.hpp"
#include "evaluation/formats/scene_set.hpp"
#include "experiments/methods/method.hpp"

#include <functional>
#include <span>
#include <vector>

namespace conelane::experiments {

/// Gets the records of each lap, in the order of the laps, from one thread at a time.
using LapSink = std::function<void(std::span<const LaneRecord>)>;

/// Runs a method on every scene, with a new detector for each lap. The first scene of a lap is answered
/// untimed before. The cut to the cone set is part of the method and of its time.
void run(const Method& method, std::span<const AnnotatedScene> scenes, const RunOptions& options,
         const LapSink& sink);

/// The same, all records at once.
[[nodiscard]] std::vector<LaneRecord> run(const Method& method, std::span<const AnnotatedScene> scenes,
                                          const RunOptions& options);

}  // namespace conelane::experiments
