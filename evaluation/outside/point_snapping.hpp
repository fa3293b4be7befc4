#pragma once

#include "conelane/scene.hpp"
#include "evaluation/files/lane_file.hpp"

#include <cstddef>
#include <string>

namespace conelane {

/// A point this near to a cone stands for the cone [m].
inline constexpr double kSnapReach_m = 0.3;

/// Turns boundaries that are points into cones where every point of both is within kSnapReach_m of one: the
/// nearest, of two equally near the one that comes first in the scene; a cone that its boundary has already
/// is not taken again. Where a point is at no cone, the record keeps its points. Other records stay as they
/// are.
void snap_to_cones(LaneRecord& record, const Scene& scene);

/// What makes an answer from outside no answer to the scene: a cone that is not there, one that is twice in a
/// boundary, more than kMaxPoints points, a point beyond kMaxCoordinate_m. Empty where nothing does.
inline constexpr std::size_t kMaxPoints = 1000;
inline constexpr double kMaxCoordinate_m = 1e7;
[[nodiscard]] std::string fault_of(const LaneRecord& record, const Scene& scene);

/// That the edges of the boundaries meet more than kMaxMeetings times, neighbours not counted; empty where
/// they do not. Such a tangle is no lane, and its area takes minutes. Precondition: fault_of finds nothing.
inline constexpr std::size_t kMaxMeetings = 500;
[[nodiscard]] std::string tangle_of(const LaneRecord& record, const Scene& scene);

}  // namespace conelane
