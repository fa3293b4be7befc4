#include "graph_search/front/front_state.hpp"

#include <algorithm>

namespace conelane {
namespace {

/// Width of a usual lane; it counts as one measured width.
constexpr float kDefaultWidth_m = 3.6F;

}  // namespace

float FrontState::mean_width_m() const {
    return (kDefaultWidth_m + width_sum_m) / static_cast<float>(1 + widths);
}

float FrontState::color_agreement() const {
    return color_sum / static_cast<float>(1 + ends[kLeft].count + ends[kRight].count);
}

bool FrontState::same_front(const FrontState& other) const {
    return std::ranges::equal(ends, other.ends, [](const FrontEnd& a, const FrontEnd& b) {
        return a.cones == b.cones && a.stopped == b.stopped;
    });
}

FrontState start_state(const FrontMap& map, Vertex left, Vertex right) {
    FrontState state;
    const std::array<Vertex, 2> cones{left, right};
    for (const Side side : {kLeft, kRight}) {
        state.ends[side].cones[0] = cones[side];
        state.ends[side].count = 1;
        // The place of the first cone counts as progress: otherwise lanes that begin later seem behind.
        state.ends[side].length_m = std::max(0.0, map.position(cones[side]).x());
        if (map.has_colors()) state.color_sum += map.color(cones[side]).speaks_for(side);
    }
    return state;
}

Side moving_side(const FrontMap& map, const FrontState& state) {
    const auto& [left, right] = state.ends;
    if (left.stopped) return kRight;
    if (right.stopped) return kLeft;
    const Point along = left.direction + right.direction;
    const Point lead = map.position(left.cones[0]) - map.position(right.cones[0]);
    return lead.dot(along) <= 0.0 ? kLeft : kRight;
}

FrontState moved(FrontMap& map, const FrontState& state, Side side, const FrontMove& move) {
    FrontState next = state;
    FrontEnd& end = next.ends[side];
    if (move.stops()) {
        end.stopped = true;
        return next;
    }
    const FrontEdge& edge = map.edges(end.cones[0])[move.edge];
    if (end.count > 1) {
        end.turn_rad = static_cast<float>(
            wrapped_angle(static_cast<double>(edge.bearing_rad) - static_cast<double>(end.bearing_rad)));
    }
    end.cones = {move.to, end.cones[0], end.cones[1]};
    end.direction = edge.direction;
    end.bearing_rad = edge.bearing_rad;
    end.segment_m = edge.length_m;
    end.log_segment = edge.log_length;
    end.length_m += static_cast<double>(edge.length_m);
    ++end.count;
    next.width_sum_m +=
        static_cast<float>(facing_distance_m(map, state.ends[opposite(side)], map.position(move.to)));
    ++next.widths;
    if (map.has_colors()) next.color_sum += map.color(move.to).speaks_for(side);
    return next;
}

}  // namespace conelane
