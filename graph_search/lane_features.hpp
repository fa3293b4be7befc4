#pragma once

#include "graph_search/lane_width.hpp"
#include "graph_search/neighbourhood.hpp"
#include "graph_search/search_graph.hpp"
#include "model/geometry.hpp"

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <string_view>

namespace conelane {

/// What the ranking of candidates sees of a lane. The first eight are those of section VII of the CLC paper,
/// in its order: (1) length, the mean of both boundaries' [m]; (2), (3) number of cones left, right; (4)
/// variance of the lane width, over W(L, R) of equation (12) with every query counted [m^2]; (5), (6)
/// variance of the segment lengths left, right [m^2]; (7), (8) variance of the signed turning angles between
/// consecutive segments left, right [rad^2]. Variances are those of the whole population, 0 where there is
/// nothing to vary. The others are this project's, see lane_feature_names.
inline constexpr std::size_t kPaperFeatureCount = 8;
inline constexpr std::size_t kLaneFeatureCount = 67;
using PaperFeatures = std::array<double, kPaperFeatureCount>;
using LaneFeatures = std::array<double, kLaneFeatureCount>;

/// A name for each feature, the unit in it; a pair of sides ends in _left, _right.
[[nodiscard]] std::span<const std::string_view> lane_feature_names();

/// The features of the paper by definition. A closed lane includes its closing segments and their angles.
/// Precondition: no boundary is empty; for a closed lane, at least three points each.
[[nodiscard]] PaperFeatures paper_features(std::span<const Point> left, std::span<const Point> right,
                                           bool closed = false);

/// Count, sum and sum of squares of what a variance is taken of.
struct Moments {
    double count = 0.0;
    double sum = 0.0;
    double sum_of_squares = 0.0;

    void add(double value) {
        count += 1.0;
        sum += value;
        sum_of_squares += value * value;
    }
    /// 0 where nothing was added, and so are the others.
    [[nodiscard]] double mean() const { return count == 0.0 ? 0.0 : sum / count; }
    [[nodiscard]] double mean_of_squares() const { return count == 0.0 ? 0.0 : sum_of_squares / count; }
    [[nodiscard]] double variance() const;
};

/// A step of a boundary from one vertex to the next belongs to the near part of the lane where it begins
/// within this distance along the boundary [m]. A lane that is wrong there is a critical failure, and what
/// is wrong with one vertex is lost in a figure of the whole lane.
inline constexpr double kNearPart_m = 20.0;

/// What the features need to know of a lane, brought up to date while it grows vertex by vertex. A value: the
/// search keeps one for each lane that it may come back to.
class LaneGrowth {
  public:
    /// A lane of one vertex a side, neither of which has a direction yet. `heading`: the car's, a unit
    /// vector.
    void start(const SearchGraph& graph, Vertex left, Vertex right, const Point& heading);
    /// Extends a side.
    void push(const SearchGraph& graph, Side side, Vertex vertex);

    /// All features but those of the width, which add_width_features sets, and what belongs to the scene
    /// (`longest_share`, `cones`, of `start_*` all but `start_skew`); these are left 0.
    [[nodiscard]] LaneFeatures features() const;
    /// By side, the vertices of the near part, its first one included.
    [[nodiscard]] std::array<std::size_t, 2> near_vertices() const;

  private:
    struct Boundary {
        Vertex last = 0;
        Point direction{0.0, 0.0};  ///< unit vector of the last segment; zero where there is none
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
        Moments offsets_m;  ///< across the boundary, from where the two vertices on each side put a vertex
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
    /// One step, as a Stretch counts it; where a boundary is too short for a figure, it is negative.
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

/// Sets the features of a lane that its widths decide: all in `lane` that LaneGrowth leaves 0 but those of
/// the scene. `near_vertices`: by side, at least one.
void add_width_features(const OnlineLaneWidth& width, const std::array<std::size_t, 2>& near_vertices,
                        LaneFeatures& lane);

/// Features that LaneGrowth leaves to others.
inline constexpr std::size_t kWidthVarianceFeature = 3;
inline constexpr std::size_t kLongestShareFeature = 8;
inline constexpr std::size_t kStartAsymmetryFeature = 9;
inline constexpr std::size_t kStartDistanceFeature = 10;
inline constexpr std::size_t kConesFeature = 11;
inline constexpr std::size_t kStartPlaceFeatures = 62;  ///< the first of five, see lane_feature_names

}  // namespace conelane
