#pragma once

#include "conelane/lane_detector.hpp"

#include <memory>

namespace conelane {

/// The same detector with answers that can be driven: a lane is `found` only where `drivable` gives it a
/// point at least. Where it gives none, the status is `stopped` with a message: the detector's best lane is
/// no lane to drive, which proves nothing of the others.
///
/// A boundary that is seen alone may wander to the other one behind a gap, so that no lane lies beside it.
/// Where that leaves no point, the boundary is cut before its first gap.
///
/// A lane without LaneAnswer::trusted_m gets one by rule, since nothing is known of its probability: up to
/// where it leaves what was seen, and 10 m at most. That is the shortest of its length, the way to the first
/// gap that is bridged, and that limit.
///
/// It costs one call of `drivable`: about 0.1 ms for a view of 30 m, more for longer lanes. That call has the
/// rest of the time limit, and 0.5 ms at least; where it takes longer the status is `stopped` by time.
[[nodiscard]] std::unique_ptr<LaneDetector> answer_drivable_lanes(std::unique_ptr<LaneDetector> detector);

}  // namespace conelane
