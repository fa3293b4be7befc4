#pragma once

#include "evaluation/formats/lane_file.hpp"
#include "evaluation/outside/outside_detector.hpp"
#include "evaluation/world/annotated_scene.hpp"

namespace conelane {

/// A point within this distance of a cone represents the cone [m].
inline constexpr double kSnapReach_m = 0.3;

/// Turns boundaries that are points into cones if every point of both is within kSnapReach_m of a cone: the
/// nearest cone, ties by their order in the scene; no cone twice in a boundary. If a point is at no cone, the
/// record keeps its points. Other records stay unchanged.
void snap_to_cones(LaneRecord& record, const Scene& scene);

/// Why an answer from outside is invalid for the scene: an unknown cone, a cone twice in a boundary, more
/// than kMaxPoints points, a point beyond kMaxCoordinate_m. Empty if it is valid.
inline constexpr std::size_t kMaxPoints = 1000;
inline constexpr double kMaxCoordinate_m = 1e7;
[[nodiscard]] std::string fault_of(const LaneRecord& record, const Scene& scene);

/// In words, if edges of the boundaries that are no neighbours cross more than kMaxMeetings times, else
/// empty. Such a tangle is not a lane, and its area takes minutes. Precondition: fault_of finds nothing.
inline constexpr std::size_t kMaxMeetings = 500;
[[nodiscard]] std::string tangle_of(const LaneRecord& record, const Scene& scene);

/// The answers of a detector `lanes:NAME=FILE` to these scenes, in their order and under its name. A scene
/// without an answer in the file gets status error and counts with the time limit of a program from outside.
/// Answers to other scenes are ignored, because a shard has only some scenes. Throws InputError naming file,
/// line and key: for invalid JSON, a scene answered twice, a cone that its scene does not have, or a file
/// that answers none of these scenes.
[[nodiscard]] std::vector<LaneRecord> read_finished_lanes(const OutsideDetector& detector,
                                                          std::span<const AnnotatedScene> scenes);

}  // namespace conelane
