#pragma once

#include "conelane/drivable_lane.hpp"
#include "model/deadline.hpp"

namespace conelane {

/// The same detector, with answers that can be driven: a lane is `found` only if `drivable` gives it a point.
/// Otherwise the status is `stopped` with a message: the detector's best lane cannot be driven, and nothing
/// is proven about other lanes.
///
/// A single boundary may wander to the opposite side behind a gap, so that no lane is beside it. If that
/// leaves no point, the boundary is cut before its first gap.
///
/// A lane without LaneAnswer::trusted_m gets one by a rule, since its probability is unknown: the smallest of
/// its length, the distance to the first bridged gap, and 10 m.
///
/// It costs one call of `drivable`: about 0.1 ms for a view of 30 m, more for longer lanes. The detector gets
/// 96 % of the time limit, or all but 2 ms if that is more, and that call gets the rest, at least 0.5 ms. If
/// it takes longer, the status is `stopped` by time.
[[nodiscard]] std::unique_ptr<LaneDetector> answer_drivable_lanes(std::unique_ptr<LaneDetector> detector);

/// The same as `drivable`; nothing if the deadline passes first. The deadline is checked at least every half
/// millisecond for lanes of up to a kilometre.
[[nodiscard]] std::optional<DrivableLane> drivable_within(const Lane& lane, const Scene& scene,
                                                          const DrivableOptions& options,
                                                          const Deadline& deadline);

}  // namespace conelane
