#pragma once

#include "graph_search/shared/search_graph.hpp"

#include <array>

namespace conelane {

/// What the left-right decider sees of a boundary: its last point and the direction of its last segment (the
/// car's heading where it has none), and the point that would come next.
struct BoundaryTip {
    Point last;
    Point direction;
    Point next;
};

/// |theta_r - theta_l| of equation (4), as a number in [0, 4] that grows with it. theta_l and theta_r are the
/// absolute angles between the last segments and the lines from each boundary's last point to the other's
/// (with signs, the difference would be about pi however the boundaries stand).
[[nodiscard]] double advance_deviation(const Point& left_last, const Point& left_direction,
                                       const Point& right_last, const Point& right_direction);

/// Left-right decider LRD, equation (5): the side whose extension keeps both boundaries more equally
/// advanced. Nothing decides a tie in the printed equation but the order of the sides; here `tie` is
/// returned, so that a scene and its mirror image are searched alike.
[[nodiscard]] Side left_right_decision(const std::array<BoundaryTip, 2>& tips, Side tie);

}  // namespace conelane
