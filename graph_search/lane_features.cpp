#include "graph_search/lane_features.hpp"

#include "graph_search/lane_width.hpp"
#include "graph_search/left_right.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace conelane {
namespace {

constexpr std::array<std::string_view, kLaneFeatureCount> kNames{
    "length_m", "cones_left", "cones_right", "width_variance_m2", "segment_length_variance_m2_left",
    "segment_length_variance_m2_right", "turn_variance_rad2_left", "turn_variance_rad2_right",
    // Length over that of the longest candidate of the scene.
    "longest_share",
    // Of the two first cones, as StartVertexRules has them.
    "start_asymmetry_m", "start_distance_m",
    // Of the scene.
    "cones",
    // Of |theta_r - theta_l| at the far ends, equation (4), as advance_deviation has it.
    "end_deviation",
    // Inside of the lane: no cone should lie there. As the triangles see them that the lane grows by.
    "cones_inside",
    // Neighbours of its cones in the search graph.
    "mean_degree", "sharpest_turn_rad", "sharpest_turn_change_rad", "longest_segment_m",
    // Chord between the direction of a segment and that of the last one opposite when it was added, squared.
    "mean_squared_skew",
    // Between the two last cones after each step.
    "mean_across_m", "across_variance_m2", "mean_segment_length_m_left", "mean_segment_length_m_right",
    "absolute_mean_turn_rad_left", "absolute_mean_turn_rad_right", "mean_squared_turn_change_rad2_left",
    "mean_squared_turn_change_rad2_right", "shortest_segment_m",
    // Largest chord between the direction of a first segment and the car's heading.
    "start_skew",
    // Within kBeside_m of a segment, not on the lane: a cone that the boundary should have gone through.
    "cones_beside",
    // At the far ends: the sharper turn, the longer segment, the last change of a turn.
    "end_turn_rad", "end_segment_m", "end_turn_change_rad"};

constexpr double kBeside_m = 1.2;

bool is_inside(const Point& point, const Point& a, const Point& b, const Point& c) {
    const double at_ab = cross(b - a, point - a);
    const double at_bc = cross(c - b, point - b);
    const double at_ca = cross(a - c, point - c);
    return (at_ab > 0.0 && at_bc > 0.0 && at_ca > 0.0) || (at_ab < 0.0 && at_bc < 0.0 && at_ca < 0.0);
}

}  // namespace

std::span<const std::string_view> lane_feature_names() {
    return kNames;
}

double Moments::variance() const {
    if (count == 0.0) return 0.0;
    return std::max(0.0, mean_of_squares() - mean() * mean());
}

PaperFeatures paper_features(std::span<const Point> left, std::span<const Point> right, bool closed) {
    PaperFeatures features{};
    const std::array<std::span<const Point>, 2> boundaries{left, right};
    const LaneWidths widths = lane_widths(left, right, closed);
    Moments width;
    for (const Side side : {kLeft, kRight}) {
        for (const double width_m : widths.of_vertex_m[side]) width.add(width_m);
        for (const double width_m : widths.of_segment_m[side]) width.add(width_m);

        const std::span<const Point> boundary = boundaries[side];
        std::vector<Point> segments;
        for (std::size_t i = 1; i < boundary.size(); ++i)
            segments.emplace_back(boundary[i] - boundary[i - 1]);
        if (closed) segments.emplace_back(boundary.front() - boundary.back());
        Moments length;
        Moments turn;
        for (const Point& segment : segments) length.add(segment.norm());
        for (std::size_t i = 1; i < segments.size(); ++i) {
            turn.add(turning_angle(segments[i - 1], segments[i]));
        }
        if (closed) turn.add(turning_angle(segments.back(), segments.front()));
        features[0] += length.sum / 2.0;
        features[1 + side] = static_cast<double>(boundary.size());
        features[4 + side] = length.variance();
        features[6 + side] = turn.variance();
    }
    features[kWidthVarianceFeature] = width.variance();
    return features;
}

void LaneGrowth::start(const SearchGraph& graph, Vertex left, Vertex right, const Point& heading) {
    *this = LaneGrowth();
    heading_ = heading;
    for (const Side side : {kLeft, kRight}) {
        boundaries_[side].last = side == kLeft ? left : right;
        tip_[side] = graph.position(boundaries_[side].last);
        degree_.add(static_cast<double>(graph.neighbours(boundaries_[side].last).size()));
    }
    across_.add((tip_[kLeft] - tip_[kRight]).norm());
}

void LaneGrowth::push(const SearchGraph& graph, Side side, Vertex vertex) {
    Boundary& own = boundaries_[side];
    const Boundary& facing = boundaries_[opposite(side)];
    const Point& facing_tip = tip_[opposite(side)];
    const Point& point = graph.position(vertex);
    const Point segment = point - tip_[side];
    const double length_m = segment.norm();
    const Point direction = segment / length_m;
    const bool has_turn = own.segment_lengths.count > 0.0;
    if (has_turn) {
        const double turn_rad = turning_angle(own.direction, direction);
        sharpest_turn_rad_ = std::max(sharpest_turn_rad_, std::abs(turn_rad));
        if (own.turns.count > 0.0) {
            const double change_rad = turn_rad - own.last_turn_rad;
            own.turn_changes.add(change_rad);
            last_turn_change_rad_ = std::abs(change_rad);
            sharpest_turn_change_rad_ = std::max(sharpest_turn_change_rad_, last_turn_change_rad_);
        }
        own.turns.add(turn_rad);
        own.last_turn_rad = turn_rad;
    } else {
        start_skew_ = std::max(start_skew_, (direction - heading_).norm());
    }
    if (facing.segment_lengths.count > 0.0) skew_.add((direction - facing.direction).norm());
    const std::span<const Vertex> neighbours = graph.neighbours(vertex);
    for (const Vertex neighbour : neighbours) {
        const Point& cone = graph.position(neighbour);
        if (is_inside(cone, tip_[side], facing_tip, point)) cones_inside_ += 1.0;
        const Point offset = cone - tip_[side];
        const double along_m = offset.dot(direction);
        if (along_m > 0.0 && along_m < length_m && std::abs(cross(direction, offset)) < kBeside_m) {
            cones_beside_ += 1.0;
        }
    }
    own.segment_lengths.add(length_m);
    own.direction = direction;
    own.last_segment_m = length_m;
    own.last = vertex;
    own.vertices += 1.0;
    tip_[side] = point;
    longest_segment_m_ = std::max(longest_segment_m_, length_m);
    shortest_segment_m_ = std::min(shortest_segment_m_, length_m);
    across_.add((point - facing_tip).norm());
    degree_.add(static_cast<double>(neighbours.size()));
}

LaneFeatures LaneGrowth::features() const {
    const Boundary& left = boundaries_[kLeft];
    const Boundary& right = boundaries_[kRight];
    LaneFeatures features{};
    features[0] = (left.segment_lengths.sum + right.segment_lengths.sum) / 2.0;
    for (const Side side : {kLeft, kRight}) {
        const Boundary& boundary = boundaries_[side];
        features[1 + side] = boundary.vertices;
        features[4 + side] = boundary.segment_lengths.variance();
        features[6 + side] = boundary.turns.variance();
        features[21 + side] = boundary.segment_lengths.mean();
        features[23 + side] = std::abs(boundary.turns.mean());
        features[25 + side] = boundary.turn_changes.mean_of_squares();
    }
    features[12] = advance_deviation(tip_[kLeft], left.direction, tip_[kRight], right.direction);
    features[13] = cones_inside_;
    features[14] = degree_.mean();
    features[15] = sharpest_turn_rad_;
    features[16] = sharpest_turn_change_rad_;
    features[17] = longest_segment_m_;
    features[18] = skew_.mean_of_squares();
    features[19] = across_.mean();
    features[20] = across_.variance();
    features[27] = shortest_segment_m_;
    features[28] = start_skew_;
    features[29] = cones_beside_;
    features[30] = std::max(std::abs(left.last_turn_rad), std::abs(right.last_turn_rad));
    features[31] = std::max(left.last_segment_m, right.last_segment_m);
    features[32] = last_turn_change_rad_;
    return features;
}

}  // namespace conelane
