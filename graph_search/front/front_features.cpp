#include "graph_search/front/front_features.hpp"

#include "graph_search/front/front_extend_features.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace conelane {
namespace {

constexpr double kPlaceReach_m = 2.5;
constexpr double kFarOff_m = 6.0;
constexpr double kStrip_m = 1.5;
constexpr double kRounding_m = 1e-3;  // lengths of edges are float

/// Color evidence of a state; all 0 if the scene has no colors.
struct StateColors {
    float share = 0.0F;
    float consistency = 0.0F;
    float agreement = 0.0F;
    float end = 0.0F;
    float other_end = 0.0F;
};

/// Inputs of the features of a state.
struct StateSeen {
    const FrontEnd& own;
    const FrontEnd& other;
    const StateMeasures& measures;
    double in;        ///< +1 if a turn to the left is inward, else -1
    double skew_rad;  ///< inward, from the own last segment to the other boundary's
    double ends_apart_m;
    double lag_m;
    double distance_m;  ///< of the end from the car
    double view_m;
    float density;
    StateColors colors;
};

constexpr std::array<FrontFeatureOf<StateSeen>, kStateFeatures> kStateSchema{{
    {"own_segment_known", "1", "1 from the second cone on: before, the heading stands for a direction",
     [](auto& s) { return s.own.count > 1 ? 1.0F : 0.0F; }},
    {"own_turn_known", "1", "1 from the third cone on",
     [](auto& s) { return s.own.count > 2 ? 1.0F : 0.0F; }},
    {"other_segment_known", "1", "the same of the other boundary",
     [](auto& s) { return s.other.count > 1 ? 1.0F : 0.0F; }},
    {"other_turn_known", "1", "the same of the other boundary",
     [](auto& s) { return s.other.count > 2 ? 1.0F : 0.0F; }},
    {"other_stopped", "1", "a side that has to go on alone soon ends",
     [](auto& s) { return s.other.stopped ? 1.0F : 0.0F; }},
    {"own_segment", "m", "cones are about evenly spaced",
     [](auto& s) { return scaled(s.own.segment_m, kLengthScale_m); }},
    {"other_segment", "m", "and on both sides alike",
     [](auto& s) { return scaled(s.other.segment_m, kLengthScale_m); }},
    {"own_turn", "rad", "the bend that is being driven, positive inward",
     [](auto& s) { return static_cast<float>(s.in) * s.own.turn_rad; }},
    {"other_turn", "rad", "the same seen by the other boundary",
     [](auto& s) { return static_cast<float>(s.in) * s.other.turn_rad; }},
    {"skew", "rad", "angle from the own last segment to the other's: boundaries are parallel",
     [](auto& s) { return static_cast<float>(s.skew_rad); }},
    {"skew_size", "rad", "its absolute value",
     [](auto& s) { return static_cast<float>(std::abs(s.skew_rad)); }},
    {"ends_apart", "m", "distance of both ends",
     [](auto& s) { return scaled(s.ends_apart_m, kLengthScale_m); }},
    {"width", "m", "from the own end to the other boundary",
     [](auto& s) { return scaled(s.measures.width_m, kLengthScale_m); }},
    {"mean_width", "m", "a lane keeps its width",
     [](auto& s) {
         return scaled(s.measures.mean_width_m, kLengthScale_m) - static_cast<float>(kDefaultWidth);
     }},
    {"lag", "m", "how far the own end is behind the other",
     [](auto& s) { return scaled(s.lag_m, kLengthScale_m, 2.0); }},
    {"mean_segment", "m", "mean length of all segments so far",
     [](auto& s) { return scaled(s.measures.mean_segment_m, kLengthScale_m); }},
    {"density", "1", "logarithm of the number of cones around: false ones make it high",
     [](auto& s) { return s.density; }},
    {"distance", "1", "of the end from the car, as a share of the view",
     [](auto& s) { return scaled(s.distance_m, std::max(s.view_m, 1.0)); }},
    {"view_left", "m", "from the end to the edge of view",
     [](auto& s) { return scaled(s.view_m - s.distance_m, kViewScale_m, kFarBeyond); }},
    {"own_cones", "1", "cones of the boundary so far, up to 8: at the beginning less is known",
     [](auto& s) { return static_cast<float>(std::min<std::size_t>(s.own.count, 8)) / 8.0F; }},
    {"color_share", "1", "share of the cones in view that have the color of a side",
     [](auto& s) { return s.colors.share; }},
    {"color_consistency", "1", "whether cones next to each other have one color: else many colors are wrong",
     [](auto& s) { return s.colors.consistency; }},
    {"color_agreement", "1", "whether the colors of the lane so far are those of their sides",
     [](auto& s) { return s.colors.agreement; }},
    {"color_end", "1", "color of the own end: 1 of its side, -1 of the other one",
     [](auto& s) { return s.colors.end; }},
    {"color_other_end", "1", "the same of the other boundary", [](auto& s) { return s.colors.other_end; }},
}};

/// Inputs of the features of a stop.
struct StopSeen {
    const Point& at;
    double distance_m;  ///< of `at` from the car
    double view_m;
    const Point& next;      ///< the next cone's place if the boundary continues on the arc
    const Point& straight;  ///< and if it continues straight on
    const Point& other_next;
    double next_off_m;
    float next_cones;
    double straight_off_m;
    std::size_t moves;
    float smoothest;
    float color_next;
    float color_goes_on;
};

constexpr std::array<FrontFeatureOf<StopSeen>, kStopFeatures> kStopSchema{{
    {"next_beyond", "m", "how far the cone that should come next, along the arc, is beyond the view",
     [](auto& s) { return scaled(s.next.norm() - s.view_m, kLengthScale_m, kFarBeyond); }},
    {"next_ahead", "m", "how far ahead of the car it would be: nothing is seen behind",
     [](auto& s) { return scaled(s.next.x(), kLengthScale_m, kFarBeyond); }},
    {"ahead", "m", "how far ahead of the car the end is",
     [](auto& s) { return scaled(s.at.x(), kViewScale_m, kFarBeyond); }},
    {"next_off", "m", "from that place to the nearest cone: nothing there, nothing to go on to",
     [](auto& s) { return scaled(s.next_off_m, kLengthScale_m); }},
    {"next_cones", "1", "cones within 2.5 m of that place, up to 3", [](auto& s) { return s.next_cones; }},
    {"straight_beyond", "m", "next_beyond where it would go on straight",
     [](auto& s) { return scaled(s.straight.norm() - s.view_m, kLengthScale_m, kFarBeyond); }},
    {"straight_ahead", "m", "next_ahead where it would go on straight",
     [](auto& s) { return scaled(s.straight.x(), kLengthScale_m, kFarBeyond); }},
    {"straight_off", "m", "next_off where it would go on straight",
     [](auto& s) { return scaled(s.straight_off_m, kLengthScale_m); }},
    {"moves", "1", "ways to go on, up to 12",
     [](auto& s) { return static_cast<float>(std::min<std::size_t>(s.moves, 12)) / 12.0F; }},
    {"smoothest", "1", "turn change and change of length of the smoothest of them",
     [](auto& s) { return s.smoothest; }},
    {"other_next_beyond", "m", "next_beyond of the other boundary: both leave the view about together",
     [](auto& s) { return scaled(s.other_next.norm() - s.view_m, kLengthScale_m, kFarBeyond); }},
    {"other_next_ahead", "m", "next_ahead of the other boundary",
     [](auto& s) { return scaled(s.other_next.x(), kLengthScale_m, kFarBeyond); }},
    {"bearing", "1", "cosine of the direction in which the car sees the end: 0 is the edge of the half disc",
     [](auto& s) { return s.distance_m > 0.0 ? static_cast<float>(s.at.x() / s.distance_m) : 0.0F; }},
    {"color_next", "1", "color of the cone nearest to where the next one would stand: 1 own, -1 the other's",
     [](auto& s) { return s.color_next; }},
    {"color_goes_on", "1", "smoothness, up to 2, of the smoothest way to a cone of the own color",
     [](auto& s) { return s.color_goes_on; }},
}};

/// Inputs of the features of a start. Both boundaries judge the pair, each with the color of its own
/// cone.
struct StartSeen {
    const StartCone& own;
    const StartCone& other;
    const Point& a;    ///< the own cone
    const Point& b;    ///< the other one
    double own_out_m;  ///< its distance from the heading's line, positive towards its side
    double other_out_m;
    double width_m;
    double lead_m;
    double middle_m;  ///< outward
    float inside;
    ConeColors colors;
};

constexpr std::array<FrontFeatureOf<StartSeen>, kStartFeatures> kStartSchema{{
    {"own_ahead", "m", "the first cones are near", [](auto& s) { return scaled(s.a.x(), 5.0); }},
    {"own_outward", "m", "and a few metres to their side", [](auto& s) { return scaled(s.own_out_m, 3.0); }},
    {"other_ahead", "m", "the same of the other cone", [](auto& s) { return scaled(s.b.x(), 5.0); }},
    {"other_outward", "m", "the same of the other cone", [](auto& s) { return scaled(s.other_out_m, 3.0); }},
    {"width", "m", "distance of both", [](auto& s) { return scaled(s.width_m, kLengthScale_m); }},
    {"lead", "m", "how far the own cone is ahead of the other",
     [](auto& s) { return scaled(s.lead_m, kLengthScale_m); }},
    {"lead_size", "m", "absolute value: they stand about level",
     [](auto& s) { return scaled(std::abs(s.lead_m), kLengthScale_m); }},
    {"middle_outward", "m", "the car drives about the middle, but for the pose error",
     [](auto& s) { return scaled(s.middle_m, 2.0); }},
    {"middle_outward_size", "m", "absolute value", [](auto& s) { return scaled(std::abs(s.middle_m), 2.0); }},
    {"own_distance", "m", "from the car", [](auto& s) { return scaled(s.a.norm(), 5.0); }},
    {"own_behind", "1", "cones in the strip behind it, up to 3: one of them may be the first",
     [](auto& s) { return s.own.behind; }},
    {"other_behind", "1", "the same of the other cone", [](auto& s) { return s.other.behind; }},
    {"inside", "1", "cones in the triangle of car and pair, up to 3: a lane is empty",
     [](auto& s) { return s.inside; }},
    {"own_continuation", "1", "how badly a segment goes on from it along the heading",
     [](auto& s) { return s.own.continuation; }},
    {"other_continuation", "1", "the same of the other cone", [](auto& s) { return s.other.continuation; }},
    {"own_predecessor", "1", "how badly a segment leads to it: a low one means it is not the first",
     [](auto& s) { return s.own.predecessor; }},
    {"other_predecessor", "1", "the same of the other cone", [](auto& s) { return s.other.predecessor; }},
    {"own_density", "1", "logarithm of the number of cones around", [](auto& s) { return s.own.density; }},
    {"other_density", "1", "the same of the other cone", [](auto& s) { return s.other.density; }},
    {"own_crosses", "m", "how far it is on the other side of the heading",
     [](auto& s) { return scaled(std::max(0.0, -s.own_out_m), 1.0); }},
    {"other_crosses", "m", "the same of the other cone",
     [](auto& s) { return scaled(std::max(0.0, -s.other_out_m), 1.0); }},
    {"slant", "1", "sine of the angle by which the pair is off square",
     [](auto& s) { return scaled(s.lead_m, std::max(s.width_m, 1.0)); }},
    {"own_passed", "1", "1 where it is behind the car, by the pose error or noise",
     [](auto& s) { return s.a.x() < 0.0 ? 1.0F : 0.0F; }},
    {"other_passed", "1", "the same of the other cone", [](auto& s) { return s.b.x() < 0.0 ? 1.0F : 0.0F; }},
    {"color_own", "1", "probability that it has the color of its side", [](auto& s) { return s.colors.own; }},
    {"color_against", "1", "that it has the other side's", [](auto& s) { return s.colors.against; }},
    {"color_orange", "1", "that it is orange: a gate, on either side",
     [](auto& s) { return s.colors.orange; }},
    {"color_none", "1", "that its color is unknown, times the share of the cones in view that have one",
     [](auto& s) { return s.colors.none; }},
    {"color_consistency", "1", "whether cones next to each other have one color: else many colors are wrong",
     [](auto& s) { return s.colors.consistency; }},
}};

/// +1 if a turn to the left is inward, -1 if it is outward.
double inward(Side side) {
    return side == kRight ? 1.0 : -1.0;
}

/// Signed angle from one direction to another.
double turn(float from_rad, float to_rad) {
    return wrapped_angle(static_cast<double>(to_rad) - static_cast<double>(from_rad));
}

/// Precondition: the map has colors.
ConeColors colors_of(const FrontMap& map, Vertex cone, Side side) {
    const ConeSide& color = map.color(cone);
    return {color.of_side[side], color.of_side[opposite(side)], color.orange,
            color.unknown() * map.color_share(), map.color_consistency()};
}

/// Mean over the segments of both sides, together with some usual lengths if there are few.
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

/// A cross product with a unit direction above this means that a cone is clearly beside a line.
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

/// Place of the cone after `end` if the boundary repeats its last segment, turned by turn_rad.
Point next_place(const FrontMap& map, const FrontEnd& end, double turn_rad, double length_m) {
    const double c = std::cos(turn_rad);
    const double s = std::sin(turn_rad);
    const Point& d = end.direction;
    return map.position(end.cones[0]) + length_m * Point(c * d.x() - s * d.y(), s * d.x() + c * d.y());
}

/// The neighbours of an end that are around a place.
struct Nearest {
    double off_m;
    float count;  ///< of those that are near
    Vertex cone;  ///< the nearest one; kNoCone if none is nearer than kFarOff_m
};

/// The cones around a place, without the cones of the front.
Nearest nearest_to(FrontMap& map, const FrontEnd& end, const FrontEnd& other, const Point& place) {
    double nearest_m2 = kFarOff_m * kFarOff_m;
    float near = 0.0F;
    Vertex nearest = kNoCone;
    // Neighbours are sorted by their distance from the end: beyond farthest_m none is around the place or
    // nearest to it.
    const double reach_m = (place - map.position(end.cones[0])).norm() + kRounding_m;
    double farthest_m = reach_m + kFarOff_m;
    for (const FrontEdge& edge : map.edges(end.cones[0])) {
        if (static_cast<double>(edge.length_m) > farthest_m) break;
        if (edge.to == end.cones[1] || edge.to == other.cones[0] || edge.to == other.cones[1]) continue;
        const double off_m2 = (map.position(edge.to) - place).squaredNorm();
        if (off_m2 < nearest_m2) {
            nearest_m2 = off_m2;
            nearest = edge.to;
            farthest_m = reach_m + std::max(std::sqrt(nearest_m2), kPlaceReach_m);
        }
        if (off_m2 < kPlaceReach_m * kPlaceReach_m) near = std::min(near + 1.0F, kMaxCounted);
    }
    return {std::sqrt(nearest_m2), near, nearest};
}

}  // namespace

std::span<const FrontFeature, kStateFeatures> state_feature_table() {
    static constexpr auto kTable = table_of(kStateSchema);
    return kTable;
}
std::span<const FrontFeature, kExtendFeatures> extend_feature_table() {
    static constexpr auto kTable = table_of(kExtendSchema);
    return kTable;
}
std::span<const FrontFeature, kStopFeatures> stop_feature_table() {
    static constexpr auto kTable = table_of(kStopSchema);
    return kTable;
}
std::span<const FrontFeature, kStartFeatures> start_feature_table() {
    static constexpr auto kTable = table_of(kStartSchema);
    return kTable;
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
    const Point along = own.direction + other.direction;
    const double along_norm = along.norm();
    StateColors colors;
    if (map.has_colors()) {
        colors = {map.color_share(), map.color_consistency(), state.color_agreement(),
                  map.color(own.cones[0]).speaks_for(side),
                  map.color(other.cones[0]).speaks_for(opposite(side))};
    }
    const StateSeen seen{.own = own,
                         .other = other,
                         .measures = measures,
                         .in = in,
                         .skew_rad = in * turn(own.bearing_rad, other.bearing_rad),
                         .ends_apart_m = (facing - at).norm(),
                         .lag_m = along_norm > 0.0 ? (facing - at).dot(along) / along_norm : 0.0,
                         .distance_m = at.norm(),
                         .view_m = map.view_radius_m(),
                         .density = map.density(own.cones[0]),
                         .colors = colors};
    return values_of<kStateSchema>(seen);
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
    const double turn_rad = in * turn(own.bearing_rad, edge.bearing_rad);
    const double mean_width_m = measures.mean_width_m;
    // The place across: to the right of a left boundary.
    const Point across = at + in * mean_width_m * Point(-edge.direction.y(), edge.direction.x());
    double partner_m2 = (facing - across).squaredNorm();
    // Neighbours are sorted by their distance from the cone: beyond this none is nearer to the place across.
    const auto farthest_m = [&] {
        return static_cast<float>(mean_width_m +
                                  std::min(kPartnerReach_m, std::sqrt(partner_m2) + kRounding_m));
    };
    float break_m = farthest_m();
    Vertex partner = other.cones[0];
    for (const FrontEdge& near : map.edges(move.to)) {
        if (near.length_m > break_m) break;
        if (near.to == from) continue;
        const double off_m2 = (map.position(near.to) - across).squaredNorm();
        if (off_m2 >= partner_m2) continue;
        partner_m2 = off_m2;
        partner = near.to;
        break_m = farthest_m();
    }
    ExtendColors colors;
    if (map.has_colors()) {
        colors.cone = colors_of(map, move.to, side);
        colors.beside = about.nearest_of_color[side];
        const double nearness = std::max(0.0, 1.0 - std::sqrt(partner_m2) / kPartnerReach_m);
        colors.partner = static_cast<float>(nearness) * map.color(partner).speaks_for(opposite(side));
    }
    const ExtendSeen seen{
        .measures = measures,
        .about = about,
        .edge = edge,
        .other = other,
        .side = side,
        .at = at,
        .facing = facing,
        .length_m = edge.length_m,
        .turn_rad = turn_rad,
        .change_rad = own.count > 2 ? wrapped_angle(turn_rad - in * own.turn_rad) : 0.0,
        .turn_other_rad = other.count > 2 ? wrapped_angle(turn_rad - in * other.turn_rad) : 0.0,
        .skew_rad = in * turn(edge.bearing_rad, other.bearing_rad),
        .width_m = facing_distance_m(map, other, at),
        .mean_width_m = mean_width_m,
        .view_m = map.view_radius_m(),
        .partner_m2 = partner_m2,
        .log_own = own.count > 1 ? edge.log_length - own.log_segment : 0.0F,
        .log_other = other.count > 1 ? edge.log_length - other.log_segment : 0.0F,
        .inside = inside_triangle(map, from, at, facing, move.to, other.cones[0], measures),
        .colors = colors};
    return values_of<kExtendSchema>(seen);
}

StopFeatures stop_features(FrontMap& map, const FrontState& state, Side side,
                           std::span<const float> extensions) {
    const FrontEnd& own = state.ends[side];
    const FrontEnd& other = state.ends[opposite(side)];
    const Point& at = map.position(own.cones[0]);
    const auto length_of = [](const FrontEnd& end) {
        return end.count > 1 ? static_cast<double>(end.segment_m) : 3.5;
    };
    const Point next = next_place(map, own, own.turn_rad, length_of(own));
    const Point straight = next_place(map, own, 0.0, length_of(own));
    const Point other_next = next_place(map, other, other.turn_rad, length_of(other));
    const auto [next_off_m, next_cones, next_cone] = nearest_to(map, own, other, next);
    constexpr std::size_t kTurnChangeSize = place_of(kExtendSchema, "turn_change_size");
    constexpr std::size_t kLogRatioOwnSize = place_of(kExtendSchema, "log_ratio_own_size");
    const std::size_t moves = extensions.size() / kExtendFeatures;
    constexpr std::size_t kColorOwn = place_of(kExtendSchema, "color_own");
    constexpr float kRough = 2.0F;
    float smoothest = kRough;
    float color_goes_on = 0.0F;
    for (std::size_t i = 0; i < moves; ++i) {
        const float* const extension = extensions.data() + i * kExtendFeatures;
        const float badness = extension[kTurnChangeSize] + extension[kLogRatioOwnSize];
        smoothest = std::min(smoothest, badness);
        color_goes_on = std::max(color_goes_on, extension[kColorOwn] * (kRough - badness));
    }
    const bool color_known = map.has_colors() && next_cone != kNoCone;
    const StopSeen seen{.at = at,
                        .distance_m = at.norm(),
                        .view_m = map.view_radius_m(),
                        .next = next,
                        .straight = straight,
                        .other_next = other_next,
                        .next_off_m = next_off_m,
                        .next_cones = next_cones,
                        .straight_off_m = nearest_to(map, own, other, straight).off_m,
                        .moves = moves,
                        .smoothest = smoothest,
                        .color_next = color_known ? map.color(next_cone).speaks_for(side) : 0.0F,
                        .color_goes_on = color_goes_on};
    return values_of<kStopSchema>(seen);
}

StartCone start_cone(FrontMap& map, Vertex cone) {
    const Point& at = map.position(cone);
    StartCone start{.cone = cone,
                    .behind = 0.0F,
                    .continuation = 2.0F,
                    .predecessor = 2.0F,
                    .density = map.density(cone)};
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
    const double width_m = (a - b).norm();
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
    ConeColors colors;
    if (map.has_colors()) colors = colors_of(map, own.cone, side);
    const StartSeen seen{.own = own,
                         .other = other,
                         .a = a,
                         .b = b,
                         .own_out_m = outward * a.y(),
                         .other_out_m = -outward * b.y(),
                         .width_m = width_m,
                         .lead_m = a.x() - b.x(),
                         .middle_m = outward * (a.y() + b.y()) / 2.0,
                         .inside = inside,
                         .colors = colors};
    return values_of<kStartSchema>(seen);
}

}  // namespace conelane
