#pragma once

#include "detectors/drivable/lane_boundary.hpp"
#include "model/deadline.hpp"
#include "model/geometry.hpp"

#include <vector>

namespace conelane {

/// Thrown when the time for a drivable lane has ended.
struct OutOfTime {};

/// Throws OutOfTime once the deadline has passed; does nothing without a deadline.
class TimeCheck {
  public:
    TimeCheck() = default;
    explicit TimeCheck(const Deadline& deadline) : deadline_(&deadline) {}

    void operator()() const {
        if (kEnds && deadline_ != nullptr && deadline_->passed()) throw OutOfTime{};
    }

  private:
#ifdef __wasi__  // exceptions are off here: the computation, some milliseconds at most, runs to its end
    static constexpr bool kEnds = false;
#else
    static constexpr bool kEnds = true;
#endif
    const Deadline* deadline_ = nullptr;
};

/// Positions on the two boundaries that face each other.
struct Rung {
    Point left;
    Point right;
    double left_m;   ///< position along the left boundary; on a closed one it may exceed the length
    double right_m;  ///< position along the right boundary

    [[nodiscard]] Point middle() const { return 0.5 * (left + right); }
};

/// Rungs of a lane in driving order, at equal distances of at most a quarter metre along the line of their
/// middles. Their number is odd; for a closed lane it is even, without repeating the first rung. None if that
/// line is shorter than 0.5 m.
struct RungLadder {
    LaneBoundary left;  ///< extended where it ends before the right boundary
    LaneBoundary right;
    std::vector<Rung> rungs;
    double spacing_m = 0.0;  ///< between the middles of successive rungs, along their line
};

/// Samples both boundaries and matches them monotonically with the least sum of squared rung lengths (dynamic
/// time warping; of equally good steps, one on both sides comes first, then one on the left).
///
/// If a boundary of an open lane ends before the other one, the matching ends at the position that faces its
/// end. From there the lane keeps its width along the other boundary, as long as that boundary stays within
/// `widest_m` of the end and does not pass the line between the two ends.
///
/// Precondition: both boundaries are closed, or both are open. Takes time and memory quadratic in the
/// boundary lengths up to 1 km; longer boundaries are sampled more coarsely.
[[nodiscard]] RungLadder lane_rungs(const LaneBoundary& left, const LaneBoundary& right, double widest_m,
                                    const TimeCheck& check_time = {});

}  // namespace conelane
