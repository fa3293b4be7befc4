#pragma once

#include "graph_search/shared/search_graph.hpp"

#include <array>

namespace conelane {

/// What the left-right decider needs of a boundary: its last point, the direction of its last segment (the
/// car's heading if there is none), and the next candidate point.
struct BoundaryTip {
    Point last;
    Point direction;
    Point next;
};

/// |theta_r - theta_l| of equation (4), as a number in [0, 4] that grows with it. theta_l and theta_r are the
/// absolute angles between the last segments and the lines from each boundary's last point to the other's.
/// (With signs, the difference would be about pi for any boundaries.)
[[nodiscard]] double advance_deviation(const Point& left_last, const Point& left_direction,
                                       const Point& right_last, const Point& right_direction);

/// Left-right decider LRD, equation (5): the side whose extension keeps both boundaries more equally
/// advanced. In the printed equation, the order of the sides decides ties; here `tie` is returned, so a scene
/// and its mirror image are searched alike.
[[nodiscard]] Side left_right_decision(const std::array<BoundaryTip, 2>& tips, Side tie);

}  // namespace conelane
