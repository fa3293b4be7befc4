#pragma once

#include "evaluation/files/lane_file.hpp"
#include "evaluation/outside/outside_detector.hpp"
#include "evaluation/scenes/annotated_scene.hpp"

#include <span>
#include <vector>

namespace conelane {

/// The answers of a detector `lanes:NAME=FILE` to these scenes, in their order and under its name. A scene
/// that the file does not answer gets an answer of status error, and counts with the limit of a program from
/// outside; answers to other scenes are left out, as a shard has some of them only. Throws InputError naming
/// file, line and key: where the file is no such JSON, answers a scene twice, names a cone that its scene has
/// not, or answers none of these scenes.
[[nodiscard]] std::vector<LaneRecord> read_finished_lanes(const OutsideDetector& detector,
                                                          std::span<const AnnotatedScene> scenes);

}  // namespace conelane
