#pragma once

#include "graph_search/front/front_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace conelane {

/// The end of a boundary that grows.
struct FrontEnd {
    std::array<Vertex, 3> cones{kNoCone, kNoCone, kNoCone};  ///< the last ones, the last one first
    Point direction{1.0, 0.0};  ///< of the last segment; the heading before there is one
    float bearing_rad = 0.0F;   ///< of `direction`, see FrontEdge
    float segment_m = 0.0F;
    float log_segment = 0.0F;
    float turn_rad = 0.0F;  ///< between the last two segments, positive to the left; 0 before there are two
    std::size_t count = 0;  ///< cones
    double length_m = 0.0;
    bool stopped = false;
};

/// All that the cost and most rules see of a lane that grows: its front.
struct FrontState {
    std::array<FrontEnd, 2> ends;
    float width_sum_m = 0.0F;  ///< of the widths that `widths` moves found
    std::size_t widths = 0;
    float color_sum = 0.0F;  ///< sum of the color evidence of its cones for their sides, see ConeSide

    /// Mean width so far, drawn towards that of a usual lane while there are few widths.
    [[nodiscard]] float mean_width_m() const;
    /// Whether the colors of its cones fit their sides: 1 if all do, -1 if all have the color of the other
    /// side. While there are few cones, it is drawn to 0.
    [[nodiscard]] float color_agreement() const;
    /// Whether two states have the same continuations, apart from the cones that are already used.
    [[nodiscard]] bool same_front(const FrontState& other) const;
    [[nodiscard]] bool finished() const { return ends[kLeft].stopped && ends[kRight].stopped; }
    /// Whether it has two cones a side.
    [[nodiscard]] bool is_lane() const { return ends[kLeft].count > 1 && ends[kRight].count > 1; }
};

/// What a boundary may do next: go on with a cone, or stop.
struct FrontMove {
    Vertex to = kNoCone;   ///< kNoCone: stop
    std::size_t edge = 0;  ///< place of the way in FrontMap::edges

    [[nodiscard]] bool stops() const { return to == kNoCone; }
};

[[nodiscard]] FrontState start_state(const FrontMap& map, Vertex left, Vertex right);

/// The side that must move: the one whose end lies behind the other's along the mean direction of both, the
/// left one where they are level; where one side has stopped, the other one. So every lane is reached by
/// exactly one sequence of moves. Precondition: not finished.
[[nodiscard]] Side moving_side(const FrontMap& map, const FrontState& state);

/// The state after that move of that side.
[[nodiscard]] FrontState moved(FrontMap& map, const FrontState& state, Side side, const FrontMove& move);

/// Distance of a cone from the other boundary, which is continued straight on.
[[nodiscard]] inline double facing_distance_m(const FrontMap& map, const FrontEnd& other, const Point& cone) {
    const Point from_end = cone - map.position(other.cones[0]);
    if (other.count < 2) return from_end.norm();
    const double along_m = from_end.dot(other.direction);
    // The last segment and its continuation; a cone behind it is measured from its beginning.
    const double before_m = std::min(0.0, along_m + static_cast<double>(other.segment_m));
    return Point(cross(other.direction, from_end), before_m).norm();
}

/// Rules that no lane may break. There is no largest width beside a boundary that goes on: it would exclude
/// true lanes in hairpins.
struct FrontRules {
    double narrowest_m = 2.0;  ///< from a new segment to the other boundary, noise included
    // Where covariances of positions are known, a rule gives way by so many standard deviations.
    double narrowest_spreads = 0.5;  ///< of the distance between both cones, see narrowest_between_m
    double turn_spreads = 1.0;       ///< of the turn, about as for three cones of the same variance
    double widest_alone_m = 7.5;     ///< from a new cone to a boundary that has stopped
    double largest_turn_rad = 110.0 * std::numbers::pi / 180.0;
    double largest_long_turn_rad = 85.0 * std::numbers::pi / 180.0;    ///< onto a segment that bridges
    double largest_first_turn_rad = 110.0 * std::numbers::pi / 180.0;  ///< from the heading
    std::size_t long_segments = 5;    ///< segments over kShortSegment_m, those that go on straightest
    std::size_t short_segments = 48;  ///< of those up to it, the shortest
    double longest_boundary_m = 300.0;
    // Of the cones that a lane may start with.
    double start_behind_m = 0.6;  ///< noise moves the first cone behind the car
    double start_ahead_m = 12.0;
    double start_across_m = 2.5;  ///< pose error: a side may be this far across the heading
    double start_aside_m = 9.0;
    double widest_start_m = 10.0;
    std::size_t start_cones = 48;  ///< of each side, the nearest to the car
};

/// How near a new cone may come to a cone of the other boundary [m]: FrontRules::narrowest_m, less where
/// their positions are uncertain, half a metre at least.
[[nodiscard]] double narrowest_between_m(const FrontMap& map, Vertex added, Vertex facing,
                                         const FrontRules& rules);

/// The moves of a side that its last cones allow: all segments up to kShortSegment_m and the straightest
/// longer ones without a cone on them, in the order of their length. FrontSearch checks rules that depend on
/// the whole lane. `left_out`: whether there are more short segments. `stops`: whether the side may stop,
/// which takes two cones.
struct FrontMoves {
    std::vector<FrontMove> extensions;
    bool stops = false;
    bool left_out = false;

    void list(FrontMap& map, const FrontState& state, Side side, const FrontRules& rules);

  private:
    /// Recomputes a cosine only if the angle has changed.
    class Cosine {
      public:
        [[nodiscard]] double of(double angle_rad) {
            if (angle_rad != angle_rad_) {
                angle_rad_ = angle_rad;
                cosine_ = std::cos(angle_rad);
            }
            return cosine_;
        }

      private:
        double angle_rad_ = 0.0;
        double cosine_ = 1.0;
    };
    struct LongSegment {
        double off_m;
        std::size_t edge;
    };
    std::vector<LongSegment> long_segments_;
    Cosine first_turn_;
    Cosine turn_;
    Cosine long_turn_;
};

/// The pairs that a lane may start with.
struct FrontStarts {
    struct Pair {
        std::size_t left;  ///< place in cones[kLeft]
        std::size_t right;
    };
    std::array<std::vector<Vertex>, 2> cones;
    std::vector<Pair> pairs;
    bool left_out = false;  ///< there are more cones than FrontRules::start_cones

    void list(const FrontMap& map, const FrontRules& rules);
};

}  // namespace conelane
