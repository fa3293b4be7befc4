#include "graph_search/clc/lane_features.hpp"

#include "graph_search/clc/deciders.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <vector>

namespace conelane {
namespace {

/// In the order of LaneFeature.
constexpr std::array<std::string_view, kLaneFeatureCount> kNames{
    // Of the paper.
    "length_m", "cones_left", "cones_right", "width_variance_m2", "segment_length_variance_m2_left",
    "segment_length_variance_m2_right", "turn_variance_rad2_left", "turn_variance_rad2_right",
    // Of the whole lane and its start.
    "longest_share", "start_asymmetry_m", "start_distance_m", "cones", "end_deviation", "cones_inside",
    "mean_degree", "sharpest_turn_rad", "sharpest_turn_change_rad", "longest_segment_m", "mean_squared_skew",
    "mean_across_m", "across_variance_m2", "mean_segment_length_m_left", "mean_segment_length_m_right",
    "absolute_mean_turn_rad_left", "absolute_mean_turn_rad_right", "mean_squared_turn_change_rad2_left",
    "mean_squared_turn_change_rad2_right", "shortest_segment_m", "start_skew", "cones_beside", "end_turn_rad",
    "end_segment_m", "end_turn_change_rad", "largest_offset_m", "rms_offset_m", "largest_skew", "narrowest_m",
    "widest_m", "largest_width_change_m",
    // Of the near part.
    "near_sharpest_turn_rad", "near_sharpest_turn_change_rad", "near_rms_turn_change_rad",
    "near_largest_offset_m", "near_rms_offset_m", "near_largest_segment_change_m",
    "near_rms_segment_change_m", "near_longest_segment_m", "near_shortest_segment_m", "near_largest_skew",
    "near_rms_skew", "near_curvature_difference_rad_per_m", "near_cones_inside", "near_cones_beside",
    "near_cones_close", "near_closeness", "near_vertices", "near_narrowest_m", "near_widest_m",
    "near_mean_width_m", "near_width_deviation_m", "near_largest_width_change_m", "near_rms_width_change_m",
    // Of the two first cones.
    "start_lead_m", "start_shift_m", "start_nearest_side_m", "start_nearest_ahead_m",
    "start_farthest_ahead_m"};
static_assert(kNames[kLength] == "length_m" && kNames[kSceneCones] == "cones" &&
              kNames[kMinWidth] == "narrowest_m" && kNames[kNearSteps] == "near_sharpest_turn_rad" &&
              kNames[kNearWidths] == "near_narrowest_m" &&
              kNames[kStartFarthestAhead] == "start_farthest_ahead_m");

/// Distance of the third of five points along a boundary, across the chord of its neighbours, from the cubic
/// through the other four at even steps [m].
double offset_m(const std::array<Point, 5>& along) {
    const Point expected = (4.0 * (along[1] + along[3]) - (along[0] + along[4])) / 6.0;
    const Point chord = along[3] - along[1];
    const double chord_m = chord.norm();
    return chord_m == 0.0 ? 0.0 : std::abs(cross(chord, along[2] - expected)) / chord_m;
}

double rms(const Moments& moments) {
    return std::sqrt(moments.mean_of_squares());
}

/// Sets features that stand next to each other.
void set(LaneFeatures& features, LaneFeature first, std::initializer_list<double> values) {
    std::ranges::copy(values, features.begin() + static_cast<std::ptrdiff_t>(first));
}

double curvature(double turned_rad, double length_m) {
    return length_m == 0.0 ? 0.0 : turned_rad / length_m;
}

}  // namespace

std::span<const std::string_view> lane_feature_names() {
    return kNames;
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
        features[kLength] += length.sum / 2.0;
        features[kConesLeft + side] = static_cast<double>(boundary.size());
        features[kSegmentLengthVarianceLeft + side] = length.variance();
        features[kTurnVarianceLeft + side] = turn.variance();
    }
    features[kWidthVariance] = width.variance();
    return features;
}

struct LaneGrowth::Step {
    double length_m = 0.0;
    double turn_rad = 0.0;  ///< with sign
    double turn_change_rad = -1.0;
    double offset_m = -1.0;
    double segment_change_m = -1.0;
    double skew = -1.0;
    Neighbourhood cones;
};

void LaneGrowth::add(const Step& step, Side side, Stretch& stretch) {
    const auto add_figure = [](double value, Moments& moments, double& largest) {
        if (value < 0.0) return;
        moments.add(value);
        largest = std::max(largest, value);
    };
    add_figure(step.skew, stretch.skew, stretch.largest_skew);
    add_figure(step.turn_change_rad, stretch.turn_changes, stretch.sharpest_turn_change_rad);
    add_figure(step.offset_m, stretch.offsets_m, stretch.largest_offset_m);
    add_figure(step.segment_change_m, stretch.segment_changes_m, stretch.largest_segment_change_m);
    stretch.sharpest_turn_rad = std::max(stretch.sharpest_turn_rad, std::abs(step.turn_rad));
    stretch.longest_segment_m = std::max(stretch.longest_segment_m, step.length_m);
    stretch.shortest_segment_m = std::min(stretch.shortest_segment_m, step.length_m);
    stretch.turned_rad[side] += step.turn_rad;
    stretch.length_m[side] += step.length_m;
    ++stretch.steps[side];
    stretch.cones.inside += step.cones.inside;
    stretch.cones.beside += step.cones.beside;
    stretch.cones.close += step.cones.close;
    stretch.cones.closeness += step.cones.closeness;
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
    Step step;
    step.length_m = segment.norm();
    const Point direction = segment / step.length_m;
    if (own.vertices > 1) {
        step.turn_rad = turning_angle(own.direction, direction);
        step.segment_change_m = std::abs(step.length_m - own.last_segment_m);
        if (own.vertices > 2) {
            const double change_rad = step.turn_rad - own.last_turn_rad;
            own.turn_changes.add(change_rad);
            step.turn_change_rad = std::abs(change_rad);
            last_turn_change_rad_ = step.turn_change_rad;
        }
        if (own.vertices > 3) {
            step.offset_m =
                offset_m({own.before_tip[2], own.before_tip[1], own.before_tip[0], tip_[side], point});
        }
        own.turns.add(step.turn_rad);
        own.last_turn_rad = step.turn_rad;
    } else {
        start_skew_ = std::max(start_skew_, (direction - heading_).norm());
    }
    if (facing.vertices > 1) step.skew = (direction - facing.direction).norm();
    step.cones = neighbourhood(graph, vertex, {.tip = tip_[side], .point = point, .facing = facing_tip});
    // The length up to the beginning of the step.
    const bool is_near = own.segment_lengths.sum <= kNearPart_m;
    add(step, side, whole_);
    if (is_near) add(step, side, near_);

    own.segment_lengths.add(step.length_m);
    own.direction = direction;
    own.before_tip = {tip_[side], own.before_tip[0], own.before_tip[1]};
    own.last_segment_m = step.length_m;
    own.last = vertex;
    ++own.vertices;
    tip_[side] = point;
    across_.add((point - facing_tip).norm());
    degree_.add(static_cast<double>(graph.neighbours(vertex).size()));
}

std::array<std::size_t, 2> LaneGrowth::near_vertices() const {
    return {near_.steps[kLeft] + 1, near_.steps[kRight] + 1};
}

LaneFeatures LaneGrowth::features() const {
    const Boundary& left = boundaries_[kLeft];
    const Boundary& right = boundaries_[kRight];
    LaneFeatures features{};
    features[kLength] = (left.segment_lengths.sum + right.segment_lengths.sum) / 2.0;
    for (const Side side : {kLeft, kRight}) {
        const Boundary& boundary = boundaries_[side];
        features[kConesLeft + side] = static_cast<double>(boundary.vertices);
        features[kSegmentLengthVarianceLeft + side] = boundary.segment_lengths.variance();
        features[kTurnVarianceLeft + side] = boundary.turns.variance();
        features[kMeanSegmentLengthLeft + side] = boundary.segment_lengths.mean();
        features[kAbsoluteMeanTurnLeft + side] = std::abs(boundary.turns.mean());
        features[kMeanSquaredTurnChangeLeft + side] = boundary.turn_changes.mean_of_squares();
    }
    features[kEndDeviation] = advance_deviation(tip_[kLeft], left.direction, tip_[kRight], right.direction);
    features[kConesInside] = whole_.cones.inside;
    features[kMeanDegree] = degree_.mean();
    features[kSharpestTurn] = whole_.sharpest_turn_rad;
    features[kSharpestTurnChange] = whole_.sharpest_turn_change_rad;
    features[kMaxSegment] = whole_.longest_segment_m;
    features[kMeanSquaredSkew] = whole_.skew.mean_of_squares();
    features[kMeanAcross] = across_.mean();
    features[kAcrossVariance] = across_.variance();
    features[kMinSegment] = whole_.shortest_segment_m;
    features[kStartSkew] = start_skew_;
    features[kConesBeside] = whole_.cones.beside;
    features[kEndTurn] = std::max(std::abs(left.last_turn_rad), std::abs(right.last_turn_rad));
    features[kEndSegment] = std::max(left.last_segment_m, right.last_segment_m);
    features[kEndTurnChange] = last_turn_change_rad_;
    features[kMaxOffset] = whole_.largest_offset_m;
    features[kRmsOffset] = rms(whole_.offsets_m);
    features[kMaxSkew] = whole_.largest_skew;
    set(features, kNearSteps,
        {near_.sharpest_turn_rad, near_.sharpest_turn_change_rad, rms(near_.turn_changes),
         near_.largest_offset_m, rms(near_.offsets_m), near_.largest_segment_change_m,
         rms(near_.segment_changes_m), near_.longest_segment_m, near_.shortest_segment_m, near_.largest_skew,
         rms(near_.skew),
         std::abs(curvature(near_.turned_rad[kLeft], near_.length_m[kLeft]) -
                  curvature(near_.turned_rad[kRight], near_.length_m[kRight])),
         near_.cones.inside, near_.cones.beside, near_.cones.close, near_.cones.closeness,
         static_cast<double>(near_.steps[kLeft] + near_.steps[kRight] + 2)});
    return features;
}

void add_width_features(const OnlineLaneWidth& width, const std::array<std::size_t, 2>& near_vertices,
                        LaneFeatures& lane) {
    struct Figures {
        double narrowest_m = std::numeric_limits<double>::infinity();
        double widest_m = 0.0;
        double largest_change_m = 0.0;
    };
    Figures whole;
    Figures near;
    Moments near_widths;
    Moments near_changes;
    for (const Side side : {kLeft, kRight}) {
        const std::span<const double> squared_m2 = width.squared_vertex_widths_m2(side);
        double before_m = std::sqrt(squared_m2[0]);
        for (std::size_t i = 0; i < squared_m2.size(); ++i) {
            const double width_m = std::sqrt(squared_m2[i]);
            const double change_m = std::abs(width_m - before_m);
            before_m = width_m;
            const auto add = [&](Figures& figures) {
                figures.narrowest_m = std::min(figures.narrowest_m, width_m);
                figures.widest_m = std::max(figures.widest_m, width_m);
                figures.largest_change_m = std::max(figures.largest_change_m, change_m);
            };
            add(whole);
            if (i >= near_vertices[side]) continue;
            add(near);
            near_widths.add(width_m);
            if (i > 0) near_changes.add(change_m);
        }
    }
    lane[kWidthVariance] = width.variance();
    lane[kMinWidth] = whole.narrowest_m;
    lane[kMaxWidth] = whole.widest_m;
    lane[kMaxWidthChange] = whole.largest_change_m;
    set(lane, kNearWidths,
        {near.narrowest_m, near.widest_m, near_widths.mean(), std::sqrt(near_widths.variance()),
         near.largest_change_m, rms(near_changes)});
}

}  // namespace conelane
