#pragma once

#include "graph_search/clc/lane_width.hpp"
#include "graph_search/clc/neighbourhood.hpp"
#include "graph_search/shared/moments.hpp"
#include "graph_search/shared/search_graph.hpp"

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <string_view>

namespace conelane {

/// What the ranking of candidates sees of a lane, as positions in LaneFeatures. The first eight are those of
/// section VII of the CLC paper, in its order: length, the mean of both boundaries' [m]; number of cones;
/// variance of the lane width, over W(L, R) of equation (12) with every query counted [m^2]; variance of the
/// segment lengths [m^2]; variance of the signed turning angles between consecutive segments [rad^2].
/// Variances are those of the whole population, 0 if there are too few values. The others are this project's.
/// lane_feature_names gives the units. Features of a pair of sides are in the order left, right: kConesLeft +
/// side.
enum LaneFeature : std::size_t {
    // The features of the paper.
    kLength,
    kConesLeft,
    kConesRight,
    kWidthVariance,
    kSegmentLengthVarianceLeft,
    kSegmentLengthVarianceRight,
    kTurnVarianceLeft,
    kTurnVarianceRight,
    // Length relative to the longest candidate of the scene.
    kMaxShare,
    // Of the two first cones, as in StartVertexRules.
    kStartAsymmetry,
    kStartDistance,
    // Of the scene.
    kSceneCones,
    // Of |theta_r - theta_l| at the far ends, equation (4), as advance_deviation has it.
    kEndDeviation,
    // Cones inside the lane, where none should be: inside the triangles by which the lane grows.
    kConesInside,
    // Neighbours of its cones in the search graph.
    kMeanDegree,
    kSharpestTurn,
    kSharpestTurnChange,
    kMaxSegment,
    // Squared chord between the directions of a new segment and of the last one opposite to it.
    kMeanSquaredSkew,
    // Between the two last cones after each step.
    kMeanAcross,
    kAcrossVariance,
    kMeanSegmentLengthLeft,
    kMeanSegmentLengthRight,
    kAbsoluteMeanTurnLeft,
    kAbsoluteMeanTurnRight,
    kMeanSquaredTurnChangeLeft,
    kMeanSquaredTurnChangeRight,
    kMinSegment,
    // Largest chord between the direction of a first segment and the car's heading.
    kStartSkew,
    // Within kBeside_m of a segment but not on the lane: cones that the boundary may have skipped.
    kConesBeside,
    // At the far ends: the sharper turn, the longer segment, the last change of a turn.
    kEndTurn,
    kEndSegment,
    kEndTurnChange,
    // Offset of a vertex from the place that the two vertices on each side of it suggest; skew as above.
    kMaxOffset,
    kRmsOffset,
    kMaxSkew,
    // Of the widths at the vertices; a change is between successive vertices of a side.
    kMinWidth,
    kMaxWidth,
    kMaxWidthChange,
    // Of the near part only: 17 of its steps and 6 of its widths, in the order of lane_feature_names. Close
    // cones are within kClose_m of a segment; closeness weighs from 1 on the segment to 0 at kBeside_m.
    kNearSteps,
    kNearWidths = kNearSteps + 17,
    // Of the two first cones again: if a false cone replaces one of them, the rest of a lane may still be
    // right.
    kStartLead = kNearWidths + 6,
    kStartShift,
    kStartNearestSide,
    kStartNearestAhead,
    kStartFarthestAhead,
    kLaneFeatureCount
};
inline constexpr std::size_t kPaperFeatureCount = 8;
using PaperFeatures = std::array<double, kPaperFeatureCount>;
using LaneFeatures = std::array<double, kLaneFeatureCount>;

/// A name for each feature, the unit in it; a pair of sides ends in _left, _right.
[[nodiscard]] std::span<const std::string_view> lane_feature_names();

/// The features of the paper by definition. A closed lane includes its closing segments and their angles.
/// Precondition: no boundary is empty; for a closed lane, at least three points each.
[[nodiscard]] PaperFeatures paper_features(std::span<const Point> left, std::span<const Point> right,
                                           bool closed = false);

/// A step of a boundary belongs to the near part of the lane if it begins within this distance along the
/// boundary [m]. A lane that is wrong there is a critical failure, and a fault at one vertex hardly shows in
/// a mean over the whole lane.
inline constexpr double kNearPart_m = 20.0;

/// State for the features of a lane, updated while it grows vertex by vertex. It is a value: the search keeps
/// a copy for each lane that it may return to.
class LaneGrowth {
  public:
    /// A lane of one vertex a side, neither of which has a direction yet. `heading`: the car's, a unit
    /// vector.
    void start(const SearchGraph& graph, Vertex left, Vertex right, const Point& heading);
    /// Extends a side.
    void push(const SearchGraph& graph, Side side, Vertex vertex);

    /// All features except those of the width, which add_width_features sets, and those that depend on the
    /// scene (kMaxShare, kSceneCones, all of kStart* but kStartSkew); these are 0.
    [[nodiscard]] LaneFeatures features() const;
    /// By side, the vertices of the near part, with its first one.
    [[nodiscard]] std::array<std::size_t, 2> near_vertices() const;

  private:
    struct Boundary {
        Vertex last = 0;
        Point direction{0.0, 0.0};  ///< unit vector of the last segment; zero if there is none
        std::array<Point, 3> before_tip{Point(0.0, 0.0), Point(0.0, 0.0),
                                        Point(0.0, 0.0)};  ///< nearest first
        std::size_t vertices = 1;
        double last_turn_rad = 0.0;
        double last_segment_m = 0.0;
        Moments segment_lengths;
        Moments turns;
        Moments turn_changes;
    };
    /// Figures of the steps of both sides, of the whole lane or of its near part.
    struct Stretch {
        Moments skew;  ///< chords between the directions of a new segment and the other side's last one
        Moments turn_changes;
        Moments
            offsets_m;  ///< across the boundary, from the place that the two vertices on each side suggest
        Moments segment_changes_m;
        double largest_skew = 0.0;
        double sharpest_turn_rad = 0.0;
        double sharpest_turn_change_rad = 0.0;
        double largest_offset_m = 0.0;
        double largest_segment_change_m = 0.0;
        double longest_segment_m = 0.0;
        double shortest_segment_m = std::numeric_limits<double>::infinity();
        std::array<double, 2> turned_rad{0.0, 0.0};  ///< by side, with sign
        std::array<double, 2> length_m{0.0, 0.0};
        std::array<std::size_t, 2> steps{0, 0};
        Neighbourhood cones;
    };
    /// One step, as a Stretch counts it; a value is negative if the boundary is too short for it.
    struct Step;
    static void add(const Step& step, Side side, Stretch& stretch);

    std::array<Boundary, 2> boundaries_;
    std::array<Point, 2> tip_{Point(0.0, 0.0), Point(0.0, 0.0)};
    Stretch whole_;
    Stretch near_;
    Moments across_;
    Moments degree_;
    Point heading_{0.0, 0.0};
    double start_skew_ = 0.0;
    double last_turn_change_rad_ = 0.0;
};

/// Sets the features that depend on widths: all that LaneGrowth leaves 0 in `lane`, except those of the
/// scene. `near_vertices`: by side, at least one.
void add_width_features(const OnlineLaneWidth& width, const std::array<std::size_t, 2>& near_vertices,
                        LaneFeatures& lane);

}  // namespace conelane
