#pragma once

#include "graph_search/clc/lane_width.hpp"

#include <numbers>

namespace conelane {

/// The geometric constraints of section VI of the CLC paper; all bounds are strict.
struct LaneBounds {
    double phi_max_rad = std::numbers::pi / 2;  ///< C_seg: turning angle between consecutive segments
    double w_min_m = 2.5;                       ///< C_width
    double w_max_m = 6.5;                       ///< C_width
};

/// Whether the search may give up a lane that violates C_width by a vertex that is too far from the other
/// boundary as built so far.
enum class WidthBacktracking {
    proven,      ///< only if no extension can satisfy the constraint: no feasible lane is missed
    left_behind  ///< also if both boundaries have passed the vertex: the fixed matchings of Lemma 3
};

/// The constraint decider CD and the backtracking decider BTD, kept up to date while a lane grows and shrinks
/// vertex by vertex.
///
/// Lemma 1, Lemma 2 and the second case of Lemma 3 hold as printed. Its first case does not hold for the
/// width that equations (11) to (13) define: a boundary that turns back may come near a vertex it has passed.
/// With WidthBacktracking::left_behind such lanes are given up, as in the paper; otherwise they are followed.
class LaneConstraints {
  public:
    struct State {
        bool feasible = false;  ///< CD
        /// BTD, for any sides that can still be extended.
        bool hopeless = false;
        /// By side: whether the lane can become feasible only by extending this side.
        std::array<bool, 2> needs{false, false};
        /// The line between the last points meets another segment: extending either side may satisfy C_poly.
        bool end_line_meets = false;

        /// BTD, given which sides can still be extended.
        [[nodiscard]] bool backtrack(bool left_extensible, bool right_extensible) const {
            return hopeless || (needs[kLeft] && !left_extensible) || (needs[kRight] && !right_extensible) ||
                   (end_line_meets && !left_extensible && !right_extensible);
        }
    };

    /// Starts a lane of one point a side.
    void reset(const Point& left, const Point& right, const LaneBounds& bounds, WidthBacktracking rule);
    /// Extends a side. `turn_allowed`: the new segment's turning angle is below phi_max; true for the first
    /// segment of a side, which has no angle limit. The segment must have a length.
    void push(Side side, const Point& point, bool turn_allowed);
    /// Undoes the last push, which was on `side`.
    void pop(Side side);

    [[nodiscard]] const State& state() const { return states_.back(); }
    [[nodiscard]] const OnlineLaneWidth& width() const { return width_; }

  private:
    [[nodiscard]] bool new_segment_meets(Side side, const Point& point) const;
    [[nodiscard]] bool end_line_meets() const;

    LaneBounds bounds_;
    WidthBacktracking rule_ = WidthBacktracking::left_behind;
    OnlineLaneWidth width_;
    std::vector<State> states_;
};

/// Whether a lane can be closed to a circuit, section IV-E of the CLC paper: on both sides the last point is
/// within d_max of the first, and the closed lane satisfies the constraints. For a closed lane these are:
/// C_seg also at both ends of each closing segment; C_width with the closing segments as queries and targets;
/// and for C_poly, each boundary is a simple polygon, they have no point in common and one encloses the
/// other. False if a side has fewer than three points.
[[nodiscard]] bool can_be_closed(std::span<const Point> left, std::span<const Point> right, double d_max_m,
                                 const LaneBounds& bounds);

}  // namespace conelane
