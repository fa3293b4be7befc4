#pragma once

#include "evaluation/formats/lane_file.hpp"
#include "evaluation/outside/outside_detector.hpp"
#include "evaluation/world/annotated_scene.hpp"

#include <span>
#include <vector>

namespace conelane {

/// The answers of a detector `lanes:NAME=FILE` to these scenes, in their order and under its name. A scene
/// without an answer in the file gets status error and counts with the time limit of a program from outside.
/// Answers to other scenes are ignored, because a shard has only some scenes. Throws InputError naming file,
/// line and key: for invalid JSON, a scene answered twice, a cone that its scene does not have, or a file
/// that answers none of these scenes.
[[nodiscard]] std::vector<LaneRecord> read_finished_lanes(const OutsideDetector& detector,
                                                          std::span<const AnnotatedScene> scenes);

}  // namespace conelane
