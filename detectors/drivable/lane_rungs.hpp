#pragma once

#include "model/deadline.hpp"
#include "model/geometry.hpp"

#include <optional>
#include <vector>

namespace conelane {

/// One boundary of a lane as a polyline, measured along its length. Positions on it are arc lengths from its
/// first vertex; on a closed boundary modulo its length.
class LaneBoundary {
  public:
    /// Vertices at one place are merged. Precondition: at least one vertex.
    LaneBoundary(const std::vector<Point>& vertices, bool closed);

    [[nodiscard]] const std::vector<Point>& vertices() const { return vertices_; }
    [[nodiscard]] bool closed() const { return closed_; }
    [[nodiscard]] std::size_t segments() const { return arc_m_.size() - 1; }
    [[nodiscard]] Segment segment(std::size_t i) const {
        return {vertices_[i], vertices_[(i + 1) % vertices_.size()]};
    }
    [[nodiscard]] double segment_start_m(std::size_t i) const { return arc_m_[i]; }
    [[nodiscard]] double segment_end_m(std::size_t i) const { return arc_m_[i + 1]; }
    [[nodiscard]] double length_m() const { return arc_m_.back(); }

    /// Distance of a point from the part of the boundary within `reach_m` of a position, measured along it.
    [[nodiscard]] double distance_m(const Point& query, double place_m, double reach_m) const;

    /// Distance along a ray to its first intersection with that part of the boundary; touching counts.
    [[nodiscard]] std::optional<double> ray_hit_m(const Point& from, const Point& unit_direction,
                                                  double place_m, double reach_m) const;

  private:
    /// Calls `visit` with the index of each segment that is partly within `reach_m` of a position.
    template <typename Visit>
    void for_segments_near(double place_m, double reach_m, const Visit& visit) const;

    std::vector<Point> vertices_;
    std::vector<double> arc_m_;  ///< at each vertex; for a closed boundary also back at the first one
    bool closed_;
};

/// The unknown boundary of a lane that is `width_m` wide: a point opposite to every half metre of the known
/// boundary, in driving order. Directions are averaged over several metres, so the inferred boundary does not
/// jump where a cone turns the known one. In narrow bends, points that run backwards or come near the known
/// boundary are left out. Precondition: the boundary is open.
[[nodiscard]] std::vector<Point> inferred_boundary(const LaneBoundary& known, bool known_is_left,
                                                   double width_m);

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
