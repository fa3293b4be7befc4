#include "graph_search/front/front_features.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>

namespace conelane {
namespace {

// The tables stand in the order in which the functions below fill the arrays.
constexpr std::array<FrontFeature, kStateFeatures> kStateTable{{
    {"own_segment_known", "1", "1 from the second cone on: before, the heading stands for a direction"},
    {"own_turn_known", "1", "1 from the third cone on"},
    {"other_segment_known", "1", "the same of the other boundary"},
    {"other_turn_known", "1", "the same of the other boundary"},
    {"other_stopped", "1", "a side that has to go on alone soon ends"},
    {"own_segment", "m", "cones are about evenly spaced"},
    {"other_segment", "m", "and on both sides alike"},
    {"own_turn", "rad", "the bend that is being driven, positive inward"},
    {"other_turn", "rad", "the same seen by the other boundary"},
    {"skew", "rad", "angle from the own last segment to the other's: boundaries are parallel"},
    {"skew_size", "rad", "its absolute value"},
    {"ends_apart", "m", "distance of both ends"},
    {"width", "m", "from the own end to the other boundary"},
    {"mean_width", "m", "a lane keeps its width"},
    {"lag", "m", "how far the own end is behind the other"},
    {"mean_segment", "m", "mean length of all segments so far"},
    {"density", "1", "logarithm of the number of cones around: false ones make it high"},
    {"distance", "1", "of the end from the car, as a share of the view"},
    {"view_left", "m", "from the end to the edge of view"},
    {"own_cones", "1", "cones of the boundary so far, up to 8: at the beginning less is known"},
}};

constexpr std::array<FrontFeature, kExtendFeatures> kExtendTable{{
    {"length", "m", "of the new segment: the rules ask for a cone every 5 m"},
    {"log_ratio_own", "1", "its length over the last one's"},
    {"log_ratio_own_size", "1", "absolute value"},
    {"log_ratio_other", "1", "its length over the other side's last one"},
    {"log_ratio_mean", "1", "its length over the mean so far"},
    {"turn", "rad", "from the last segment, positive inward"},
    {"turn_size", "rad", "absolute value: boundaries bend little"},
    {"turn_change", "rad", "from the last turn: bends are arcs"},
    {"turn_change_size", "rad", "absolute value"},
    {"turn_other", "rad", "less that of the other boundary: both bend alike"},
    {"turn_other_size", "rad", "absolute value"},
    {"skew", "rad", "angle from the new segment to the other side's last one"},
    {"skew_size", "rad", "absolute value: they are parallel"},
    {"width", "m", "from the new cone to the other boundary"},
    {"width_deviation", "m", "absolute difference to the mean so far"},
    {"width_change", "m", "from that of the cone before"},
    {"diagonal", "m", "from the new cone to the other's last one"},
    {"lead", "m", "how far the new cone is before the other's last one"},
    {"inside", "1", "cones in the triangle just swept, up to 3: a lane is empty"},
    {"beside_inward", "1", "nearness of the nearest cone beside the segment, inside: one was skipped"},
    {"beside_outward", "1", "the same outside"},
    {"beside", "1", "nearness summed over all cones beside it"},
    {"within_disc", "1", "cones in the disc about the segment, up to 4: neighbours have none between them"},
    {"continuation", "1", "how badly the best next segment goes on: the boundary does not end here"},
    {"partner", "m", "from the place across, a lane width off, to the nearest cone there"},
    {"bridges", "1", "1 for a segment of more than 5.8 m: a cone was missed"},
    {"view_left", "m", "from the new cone to the edge of view"},
    {"crowding", "1", "nearness of the nearest cone to the new one: boundary cones stand alone"},
}};

constexpr std::array<FrontFeature, kStopFeatures> kStopTable{{
    {"next_beyond", "m", "how far the cone that should come next, along the arc, is beyond the view"},
    {"next_ahead", "m", "how far ahead of the car it would be: nothing is seen behind"},
    {"ahead", "m", "how far ahead of the car the end is"},
    {"next_off", "m", "from that place to the nearest cone: nothing there, nothing to go on to"},
    {"next_cones", "1", "cones within 2.5 m of that place, up to 3"},
    {"straight_beyond", "m", "next_beyond where it would go on straight"},
    {"straight_ahead", "m", "next_ahead where it would go on straight"},
    {"straight_off", "m", "next_off where it would go on straight"},
    {"moves", "1", "ways to go on, up to 12"},
    {"smoothest", "1", "turn change and change of length of the smoothest of them"},
    {"other_next_beyond", "m", "next_beyond of the other boundary: both leave the view about together"},
    {"other_next_ahead", "m", "next_ahead of the other boundary"},
    {"bearing", "1", "cosine of the direction in which the car sees the end: 0 is the edge of the half disc"},
}};

constexpr std::array<FrontFeature, kStartFeatures> kStartTable{{
    {"own_ahead", "m", "the first cones are near"},
    {"own_outward", "m", "and a few metres to their side"},
    {"other_ahead", "m", "the same of the other cone"},
    {"other_outward", "m", "the same of the other cone"},
    {"width", "m", "distance of both"},
    {"lead", "m", "how far the own cone is ahead of the other"},
    {"lead_size", "m", "absolute value: they stand about level"},
    {"middle_outward", "m", "the car drives about the middle, but for the pose error"},
    {"middle_outward_size", "m", "absolute value"},
    {"own_distance", "m", "from the car"},
    {"own_behind", "1", "cones in the strip behind it, up to 3: one of them may be the first"},
    {"other_behind", "1", "the same of the other cone"},
    {"inside", "1", "cones in the triangle of car and pair, up to 3: a lane is empty"},
    {"own_continuation", "1", "how badly a segment goes on from it along the heading"},
    {"other_continuation", "1", "the same of the other cone"},
    {"own_predecessor", "1", "how badly a segment leads to it: a low one means it is not the first"},
    {"other_predecessor", "1", "the same of the other cone"},
    {"own_density", "1", "logarithm of the number of cones around"},
    {"other_density", "1", "the same of the other cone"},
    {"own_crosses", "m", "how far it is on the other side of the heading"},
    {"other_crosses", "m", "the same of the other cone"},
    {"slant", "1", "sine of the angle by which the pair is off square"},
    {"own_passed", "1", "1 where it is behind the car, by the pose error or noise"},
    {"other_passed", "1", "the same of the other cone"},
}};

// What a value is divided by so that it is about 1, and what it is cut at: nothing is told by more.
constexpr double kLength_m = 4.0;
constexpr double kView_m = 10.0;
constexpr double kFarBeyond = 2.0;
constexpr double kPartnerReach_m = 3.0;
constexpr double kPlaceReach_m = 2.5;
constexpr double kFarOff_m = 6.0;
constexpr double kDefaultWidth = 0.9;
constexpr double kStrip_m = 1.5;
constexpr double kRounding_m = 1e-3;  // lengths of edges are float
constexpr float kMaxCounted = 3.0F;

float scaled(double value, double unit, double most = 4.0) {
    return static_cast<float>(std::clamp(value / unit, -most, most));
}

/// +1 where a turn to the left is inward, -1 where it is outward.
double inward(Side side) {
    return side == kRight ? 1.0 : -1.0;
}

/// From a direction to another one.
double turn(float from_rad, float to_rad) {
    return wrapped_angle(static_cast<double>(to_rad) - static_cast<double>(from_rad));
}

/// Of the segments of both sides, some usual ones where there are few.
double mean_segment_m(const FrontState& state) {
    double sum_m = 3.5;
    double count = 1.0;
    for (const FrontEnd& end : state.ends) {
        if (end.count < 2) continue;
        sum_m += static_cast<double>(end.segment_m);
        count += 1.0;
        if (end.count > 2) {
            sum_m += end.length_m / static_cast<double>(end.count - 1);
            count += 1.0;
        }
    }
    return sum_m / count;
}

/// What a cross product of a direction has to exceed so that a cone clearly lies beside a line.
constexpr double kClearly = 1e-9;

/// Cones of `from`'s neighbours strictly inside the triangle of `from`, b and the other end c, up to
/// kMaxCounted.
float inside_triangle(FrontMap& map, Vertex from, const Point& b, const Point& c, Vertex b_cone,
                      Vertex c_cone, const StateMeasures& measures) {
    const Point& a = map.position(from);
    const double area = cross(b - a, c - a);
    const double sign = area < 0.0 ? -1.0 : 1.0;
    const auto farthest = static_cast<float>(std::max((b - a).norm(), (c - a).norm()));
    const Point along_b = sign * (b - a);
    const Side b_side = area < 0.0 ? kLeft : kRight;  // of the line to c
    const std::span<const FrontEdge> edges = map.edges(from);
    float count = 0.0F;
    for (const std::uint8_t way : std::span(measures.ways[b_side]).first(measures.way_counts[b_side])) {
        const FrontEdge& edge = edges[way];
        if (edge.length_m > farthest) break;
        if (cross(along_b, edge.direction) < -kClearly) continue;
        if (edge.to == b_cone || edge.to == c_cone) continue;
        const Point& p = map.position(edge.to);
        if (sign * cross(b - a, p - a) > 0.0 && sign * cross(c - b, p - b) > 0.0 &&
            sign * cross(a - c, p - c) > 0.0) {
            count += 1.0F;
            if (count == kMaxCounted) break;
        }
    }
    return count;
}

/// Where the cone after `end` would stand if it went on by the same segment, turned by turn_rad.
Point next_place(const FrontMap& map, const FrontEnd& end, double turn_rad, double length_m) {
    const double c = std::cos(turn_rad);
    const double s = std::sin(turn_rad);
    const Point& d = end.direction;
    return map.position(end.cones[0]) + length_m * Point(c * d.x() - s * d.y(), s * d.x() + c * d.y());
}

/// Distance from a place to the nearest neighbour of the end that is not on the front, and how many are near.
std::pair<double, float> nearest_to(FrontMap& map, const FrontEnd& end, const FrontEnd& other,
                                    const Point& place) {
    double nearest_m2 = kFarOff_m * kFarOff_m;
    float near = 0.0F;
    // Neighbours come by their distance from the end: beyond farthest_m none is near the place or nearest to
    // it.
    const double reach_m = (place - map.position(end.cones[0])).norm() + kRounding_m;
    double farthest_m = reach_m + kFarOff_m;
    for (const FrontEdge& edge : map.edges(end.cones[0])) {
        if (static_cast<double>(edge.length_m) > farthest_m) break;
        if (edge.to == end.cones[1] || edge.to == other.cones[0] || edge.to == other.cones[1]) continue;
        const double off_m2 = (map.position(edge.to) - place).squaredNorm();
        if (off_m2 < nearest_m2) {
            nearest_m2 = off_m2;
            farthest_m = reach_m + std::max(std::sqrt(nearest_m2), kPlaceReach_m);
        }
        if (off_m2 < kPlaceReach_m * kPlaceReach_m) near = std::min(near + 1.0F, kMaxCounted);
    }
    return {std::sqrt(nearest_m2), near};
}

}  // namespace

std::span<const FrontFeature, kStateFeatures> state_feature_table() {
    return kStateTable;
}
std::span<const FrontFeature, kExtendFeatures> extend_feature_table() {
    return kExtendTable;
}
std::span<const FrontFeature, kStopFeatures> stop_feature_table() {
    return kStopTable;
}
std::span<const FrontFeature, kStartFeatures> start_feature_table() {
    return kStartTable;
}

StateMeasures measure(FrontMap& map, const FrontState& state, Side side) {
    const FrontEnd& other = state.ends[opposite(side)];
    const Vertex end = state.ends[side].cones[0];
    StateMeasures measures;
    measures.width_m = facing_distance_m(map, other, map.position(end));
    measures.mean_width_m = state.mean_width_m();
    measures.mean_segment_m = mean_segment_m(state);
    measures.log_mean_segment = static_cast<float>(std::log(measures.mean_segment_m));
    static_assert(FrontMap::kMaxEdges <= std::numeric_limits<std::uint8_t>::max());
    const Point across = map.position(other.cones[0]) - map.position(end);
    const std::span<const FrontEdge> edges = map.edges(end);
    std::size_t left = 0;
    std::size_t right = 0;
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const double off = cross(across, edges[i].direction);
        measures.ways[kLeft][left] = static_cast<std::uint8_t>(i);
        measures.ways[kRight][right] = static_cast<std::uint8_t>(i);
        left += off >= -kClearly ? 1 : 0;
        right += off <= kClearly ? 1 : 0;
    }
    measures.way_counts = {left, right};
    return measures;
}

StateFeatures state_features(FrontMap& map, const FrontState& state, Side side,
                             const StateMeasures& measures) {
    const FrontEnd& own = state.ends[side];
    const FrontEnd& other = state.ends[opposite(side)];
    const Point& at = map.position(own.cones[0]);
    const Point& facing = map.position(other.cones[0]);
    const double in = inward(side);
    const double skew_rad = in * turn(own.bearing_rad, other.bearing_rad);
    const Point along = own.direction + other.direction;
    const double along_norm = along.norm();
    const double lag_m = along_norm > 0.0 ? (facing - at).dot(along) / along_norm : 0.0;
    const double distance_m = at.norm();
    return {own.count > 1 ? 1.0F : 0.0F,
            own.count > 2 ? 1.0F : 0.0F,
            other.count > 1 ? 1.0F : 0.0F,
            other.count > 2 ? 1.0F : 0.0F,
            other.stopped ? 1.0F : 0.0F,
            scaled(own.segment_m, kLength_m),
            scaled(other.segment_m, kLength_m),
            static_cast<float>(in) * own.turn_rad,
            static_cast<float>(in) * other.turn_rad,
            static_cast<float>(skew_rad),
            static_cast<float>(std::abs(skew_rad)),
            scaled((facing - at).norm(), kLength_m),
            scaled(measures.width_m, kLength_m),
            scaled(measures.mean_width_m, kLength_m) - static_cast<float>(kDefaultWidth),
            scaled(lag_m, kLength_m, 2.0),
            scaled(measures.mean_segment_m, kLength_m),
            map.density(own.cones[0]),
            scaled(distance_m, std::max(map.view_radius_m(), 1.0)),
            scaled(map.view_radius_m() - distance_m, kView_m, kFarBeyond),
            static_cast<float>(std::min<std::size_t>(own.count, 8)) / 8.0F};
}

ExtendFeatures extend_features(FrontMap& map, const FrontState& state, Side side, const FrontMove& move,
                               const StateMeasures& measures) {
    const FrontEnd& own = state.ends[side];
    const FrontEnd& other = state.ends[opposite(side)];
    const Vertex from = own.cones[0];
    const EdgeNeighbourhood about = map.neighbourhood(from, move.edge);
    const FrontEdge edge = map.edges(from)[move.edge];
    const Point& at = map.position(move.to);
    const Point& facing = map.position(other.cones[0]);
    const double in = inward(side);
    const double length_m = edge.length_m;
    const double turn_rad = in * turn(own.bearing_rad, edge.bearing_rad);
    const double change_rad = own.count > 2 ? wrapped_angle(turn_rad - in * own.turn_rad) : 0.0;
    const double turn_other_rad = other.count > 2 ? wrapped_angle(turn_rad - in * other.turn_rad) : 0.0;
    const double skew_rad = in * turn(edge.bearing_rad, other.bearing_rad);
    const double width_m = facing_distance_m(map, other, at);
    const double mean_width_m = measures.mean_width_m;
    const float log_own = own.count > 1 ? edge.log_length - own.log_segment : 0.0F;
    const float log_other = other.count > 1 ? edge.log_length - other.log_segment : 0.0F;
    // The place across: to the right of a left boundary.
    const Point across = at + in * mean_width_m * Point(-edge.direction.y(), edge.direction.x());
    double partner_m2 = (facing - across).squaredNorm();
    // Neighbours come by their distance from the cone: beyond this one none is nearer to the place across.
    const auto farthest_m = [&] {
        return static_cast<float>(mean_width_m +
                                  std::min(kPartnerReach_m, std::sqrt(partner_m2) + kRounding_m));
    };
    float break_m = farthest_m();
    for (const FrontEdge& near : map.edges(move.to)) {
        if (near.length_m > break_m) break;
        if (near.to == from) continue;
        const double off_m2 = (map.position(near.to) - across).squaredNorm();
        if (off_m2 >= partner_m2) continue;
        partner_m2 = off_m2;
        break_m = farthest_m();
    }
    return {scaled(length_m, kLength_m),
            log_own,
            std::abs(log_own),
            log_other,
            edge.log_length - measures.log_mean_segment,
            static_cast<float>(turn_rad),
            static_cast<float>(std::abs(turn_rad)),
            static_cast<float>(change_rad),
            static_cast<float>(std::abs(change_rad)),
            static_cast<float>(turn_other_rad),
            static_cast<float>(std::abs(turn_other_rad)),
            static_cast<float>(skew_rad),
            static_cast<float>(std::abs(skew_rad)),
            scaled(width_m, kLength_m) - static_cast<float>(kDefaultWidth),
            scaled(std::abs(width_m - mean_width_m), 1.0),
            scaled(width_m - measures.width_m, kLength_m),
            scaled((facing - at).norm(), kLength_m),
            scaled((at - facing).dot(other.direction), kLength_m, kFarBeyond),
            inside_triangle(map, from, at, facing, move.to, other.cones[0], measures),
            about.nearest_beside[side == kRight ? kLeft : kRight],
            about.nearest_beside[side],
            std::min(about.beside, kMaxCounted),
            std::min(about.within_disc, 4.0F) / 2.0F,
            about.continuation,
            scaled(std::sqrt(partner_m2), kPartnerReach_m, 1.0),
            length_m > kShortSegment_m ? 1.0F : 0.0F,
            scaled(map.view_radius_m() - at.norm(), kView_m, kFarBeyond),
            about.crowding};
}

StopFeatures stop_features(FrontMap& map, const FrontState& state, Side side,
                           std::span<const float> extensions) {
    const FrontEnd& own = state.ends[side];
    const FrontEnd& other = state.ends[opposite(side)];
    const Point& at = map.position(own.cones[0]);
    const double view_m = map.view_radius_m();
    const auto length_of = [](const FrontEnd& end) {
        return end.count > 1 ? static_cast<double>(end.segment_m) : 3.5;
    };
    const Point next = next_place(map, own, own.turn_rad, length_of(own));
    const Point straight = next_place(map, own, 0.0, length_of(own));
    const Point other_next = next_place(map, other, other.turn_rad, length_of(other));
    const auto [next_off_m, next_cones] = nearest_to(map, own, other, next);
    const double straight_off_m = nearest_to(map, own, other, straight).first;
    const std::size_t moves = extensions.size() / kExtendFeatures;
    float smoothest = 2.0F;
    for (std::size_t i = 0; i < moves; ++i) {
        const float* const extension = extensions.data() + i * kExtendFeatures;
        smoothest = std::min(
            smoothest, extension[ExtendPlace::kTurnChangeSize] + extension[ExtendPlace::kLogRatioOwnSize]);
    }
    const double distance_m = at.norm();
    return {scaled(next.norm() - view_m, kLength_m, kFarBeyond),
            scaled(next.x(), kLength_m, kFarBeyond),
            scaled(at.x(), kView_m, kFarBeyond),
            scaled(next_off_m, kLength_m),
            next_cones,
            scaled(straight.norm() - view_m, kLength_m, kFarBeyond),
            scaled(straight.x(), kLength_m, kFarBeyond),
            scaled(straight_off_m, kLength_m),
            static_cast<float>(std::min<std::size_t>(moves, 12)) / 12.0F,
            smoothest,
            scaled(other_next.norm() - view_m, kLength_m, kFarBeyond),
            scaled(other_next.x(), kLength_m, kFarBeyond),
            distance_m > 0.0 ? static_cast<float>(at.x() / distance_m) : 0.0F};
}

StartCone start_cone(FrontMap& map, Vertex cone) {
    const Point& at = map.position(cone);
    StartCone start{cone, 0.0F, 2.0F, 2.0F, map.density(cone)};
    for (const FrontEdge& edge : map.edges(cone)) {
        const Point way = map.position(edge.to) - at;
        if (way.x() < 0.0 && std::abs(way.y()) < kStrip_m && map.position(edge.to).x() > -0.6) {
            start.behind = std::min(start.behind + 1.0F, kMaxCounted);
        }
        if (edge.length_m > static_cast<float>(kShortSegment_m)) continue;
        const auto bend_rad = std::abs(edge.bearing_rad);
        start.continuation = std::min(start.continuation, bend_rad);
        start.predecessor = std::min(start.predecessor, static_cast<float>(std::numbers::pi) - bend_rad);
    }
    return start;
}

StartFeatures start_features(FrontMap& map, const StartCone& own, const StartCone& other, Side side) {
    const Point& a = map.position(own.cone);
    const Point& b = map.position(other.cone);
    const double outward = -inward(side);
    const double own_out_m = outward * a.y();
    const double other_out_m = -outward * b.y();
    const double width_m = (a - b).norm();
    const double lead_m = a.x() - b.x();
    const double middle_m = outward * (a.y() + b.y()) / 2.0;
    // Cones in the triangle of the car and the pair.
    float inside = 0.0F;
    const double area = cross(a, b);
    const double sign = area < 0.0 ? -1.0 : 1.0;
    for (const FrontEdge& edge : map.edges(own.cone)) {
        if (edge.length_m > static_cast<float>(std::max(width_m, a.norm()))) break;
        if (edge.to == other.cone) continue;
        const Point& p = map.position(edge.to);
        if (sign * cross(a, p) > 0.0 && sign * cross(b - a, p - a) > 0.0 && sign * cross(-b, p - b) > 0.0) {
            inside = std::min(inside + 1.0F, kMaxCounted);
        }
    }
    return {scaled(a.x(), 5.0),
            scaled(own_out_m, 3.0),
            scaled(b.x(), 5.0),
            scaled(other_out_m, 3.0),
            scaled(width_m, kLength_m),
            scaled(lead_m, kLength_m),
            scaled(std::abs(lead_m), kLength_m),
            scaled(middle_m, 2.0),
            scaled(std::abs(middle_m), 2.0),
            scaled(a.norm(), 5.0),
            own.behind,
            other.behind,
            inside,
            own.continuation,
            other.continuation,
            own.predecessor,
            other.predecessor,
            own.density,
            other.density,
            scaled(std::max(0.0, -own_out_m), 1.0),
            scaled(std::max(0.0, -other_out_m), 1.0),
            scaled(lead_m, std::max(width_m, 1.0)),
            a.x() < 0.0 ? 1.0F : 0.0F,
            b.x() < 0.0 ? 1.0F : 0.0F};
}

}  // namespace conelane
