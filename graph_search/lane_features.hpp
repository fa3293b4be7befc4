#pragma once

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
inline constexpr std::size_t kLaneFeatureCount = 33;
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

/// What the features need to know of a lane, brought up to date while it grows vertex by vertex. A value: the
/// search keeps one for each lane that it may come back to.
class LaneGrowth {
  public:
    /// A lane of one vertex a side, neither of which has a direction yet. `heading`: the car's, a unit
    /// vector.
    void start(const SearchGraph& graph, Vertex left, Vertex right, const Point& heading);
    /// Extends a side.
    void push(const SearchGraph& graph, Side side, Vertex vertex);

    /// All features but the variance of the width and what belongs to the scene (`longest_share`, `start_*`,
    /// `cones`), which are left 0.
    [[nodiscard]] LaneFeatures features() const;

  private:
    struct Boundary {
        Vertex last = 0;
        Point direction{0.0, 0.0};  ///< unit vector of the last segment; zero where there is none
        double vertices = 1.0;
        double last_turn_rad = 0.0;
        double last_segment_m = 0.0;
        Moments segment_lengths;
        Moments turns;
        Moments turn_changes;
    };

    std::array<Boundary, 2> boundaries_;
    std::array<Point, 2> tip_{Point(0.0, 0.0), Point(0.0, 0.0)};
    Moments skew_;  ///< chords between the directions of a new segment and the other side's last one
    Moments across_;
    Moments degree_;
    double sharpest_turn_rad_ = 0.0;
    double sharpest_turn_change_rad_ = 0.0;
    double longest_segment_m_ = 0.0;
    double shortest_segment_m_ = std::numeric_limits<double>::infinity();
    Point heading_{0.0, 0.0};
    double start_skew_ = 0.0;
    double cones_beside_ = 0.0;
    double last_turn_change_rad_ = 0.0;
    double cones_inside_ = 0.0;
};

/// Features that LaneGrowth leaves to others.
inline constexpr std::size_t kWidthVarianceFeature = 3;
inline constexpr std::size_t kLongestShareFeature = 8;
inline constexpr std::size_t kStartAsymmetryFeature = 9;
inline constexpr std::size_t kStartDistanceFeature = 10;
inline constexpr std::size_t kConesFeature = 11;

}  // namespace conelane
