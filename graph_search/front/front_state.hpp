#pragma once

#include "graph_search/front/front_map.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace conelane {

/// The end of a boundary that grows.
struct FrontEnd {
    std::array<Vertex, 3> cones{kNoCone, kNoCone, kNoCone};  ///< the last ones, the last one first
    Point direction{1.0, 0.0};  ///< of the last segment; the heading before there is one
    float bearing_rad = 0.0F;   ///< of `direction`, see FrontEdge
    float segment_m = 0.0F;
    float log_segment = 0.0F;
    float turn_rad = 0.0F;  ///< between the last two segments, positive to the left; 0 before there are two
    std::size_t count = 0;  ///< cones
    double length_m = 0.0;
    bool stopped = false;
};

/// All that the cost and most rules see of a lane that grows: its front.
struct FrontState {
    std::array<FrontEnd, 2> ends;
    float width_sum_m = 0.0F;  ///< of the widths that `widths` moves found
    std::size_t widths = 0;
    float color_sum = 0.0F;  ///< sum of the color evidence of its cones for their sides, see ConeSide

    /// Mean width so far, drawn towards that of a usual lane while there are few widths.
    [[nodiscard]] float mean_width_m() const;
    /// Whether the colors of its cones fit their sides: 1 if all do, -1 if all have the color of the other
    /// side. While there are few cones, it is drawn to 0.
    [[nodiscard]] float color_agreement() const;
    /// Whether two states have the same continuations, apart from the cones that are already used.
    [[nodiscard]] bool same_front(const FrontState& other) const;
    [[nodiscard]] bool finished() const { return ends[kLeft].stopped && ends[kRight].stopped; }
    /// Whether it has two cones a side.
    [[nodiscard]] bool is_lane() const { return ends[kLeft].count > 1 && ends[kRight].count > 1; }
};

/// What a boundary may do next: go on with a cone, or stop.
struct FrontMove {
    Vertex to = kNoCone;   ///< kNoCone: stop
    std::size_t edge = 0;  ///< place of the way in FrontMap::edges

    [[nodiscard]] bool stops() const { return to == kNoCone; }
};

[[nodiscard]] FrontState start_state(const FrontMap& map, Vertex left, Vertex right);

/// The side that must move: the one whose end lies behind the other's along the mean direction of both, the
/// left one where they are level; where one side has stopped, the other one. So every lane is reached by
/// exactly one sequence of moves. Precondition: not finished.
[[nodiscard]] Side moving_side(const FrontMap& map, const FrontState& state);

/// The state after that move of that side.
[[nodiscard]] FrontState moved(FrontMap& map, const FrontState& state, Side side, const FrontMove& move);

/// Distance of a cone from the other boundary, which is continued straight on.
[[nodiscard]] inline double facing_distance_m(const FrontMap& map, const FrontEnd& other, const Point& cone) {
    const Point from_end = cone - map.position(other.cones[0]);
    if (other.count < 2) return from_end.norm();
    const double along_m = from_end.dot(other.direction);
    // The last segment and its continuation; a cone behind it is measured from its beginning.
    const double before_m = std::min(0.0, along_m + static_cast<double>(other.segment_m));
    return Point(cross(other.direction, from_end), before_m).norm();
}

}  // namespace conelane
