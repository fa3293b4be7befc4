#pragma once

#include "conelane/scene.hpp"
#include "graph_search/shared/search_graph.hpp"

#include <array>
#include <numbers>

namespace conelane {

/// No cone.
inline constexpr Vertex kNoCone = ~Vertex{0};

/// Longest segment of a boundary [m]: in a dense scene, and if a cone has few neighbours; and the longest one
/// that bridges nothing (by the rules, cones are at most 5 m apart).
inline constexpr double kMaxSegment_m = 11.5;
inline constexpr double kMaxLengthAmongFew_m = 15.5;
inline constexpr double kShortSegment_m = 5.8;

/// Angle from a to b, by their cross and dot product, in [-pi, pi] rad; 0 if both are 0. An approximation
/// to 2e-5 rad without the C library, hence the same on any machine.
[[nodiscard]] double front_angle(double cross, double dot);

/// The same angle in (-pi, pi], for one in (-3 pi, 3 pi).
[[nodiscard]] inline double wrapped_angle(double angle_rad) {
    if (angle_rad > std::numbers::pi) return angle_rad - 2.0 * std::numbers::pi;
    if (angle_rad <= -std::numbers::pi) return angle_rad + 2.0 * std::numbers::pi;
    return angle_rad;
}

/// Whether two segments are farther apart than `gap_m`. False does not mean that they are nearer.
[[nodiscard]] inline bool far_apart(const Segment& a, const Segment& b, double gap_m) {
    return std::min(a.from.x(), a.to.x()) > std::max(b.from.x(), b.to.x()) + gap_m ||
           std::min(b.from.x(), b.to.x()) > std::max(a.from.x(), a.to.x()) + gap_m ||
           std::min(a.from.y(), a.to.y()) > std::max(b.from.y(), b.to.y()) + gap_m ||
           std::min(b.from.y(), b.to.y()) > std::max(a.from.y(), a.to.y()) + gap_m;
}

/// Whether two segments come closer than `gap_m` or cross.
[[nodiscard]] inline bool come_within(const Segment& a, const Segment& b, double gap_m) {
    if (far_apart(a, b, gap_m)) return false;
    const auto is_near = [gap_m](const Point& end, const Segment& segment) {
        const Point along = segment.to - segment.from;
        const double squared_m2 = along.squaredNorm();
        const double share =
            squared_m2 > 0.0 ? std::clamp((end - segment.from).dot(along) / squared_m2, 0.0, 1.0) : 0.0;
        return (end - (segment.from + share * along)).squaredNorm() < gap_m * gap_m;
    };
    return is_near(a.from, b) || is_near(a.to, b) || is_near(b.from, a) || is_near(b.to, a) ||
           segments_intersect(a, b);
}

/// The way from a cone to another one.
struct FrontEdge {
    Vertex to;
    float length_m;
    float log_length = 0.0F;   ///< natural logarithm of the length in metres
    float bearing_rad = 0.0F;  ///< angle from the heading of the car to `direction`
    Point direction;           ///< unit vector
};

/// What is around the way from a cone to another one. Left and right as seen along it.
struct EdgeNeighbourhood {
    bool known = false;
    bool blocked = false;  ///< a cone within 0.2 m of the middle 70 %
    /// How near the nearest cone beside it is, from 0 (2 m or more) to 1 (on it).
    std::array<float, 2> nearest_beside{};
    float beside = 0.0F;        ///< the same, summed over all cones on both sides
    float within_disc = 0.0F;   ///< cones in the disc that has the way as diameter
    float continuation = 0.0F;  ///< how badly the best next segment goes on: bend + change of log length
    float crowding = 0.0F;      ///< how near the nearest cone at its end is, as nearest_beside
    /// As nearest_beside, on either side, but only for cones of one color, weighted by the probability of
    /// that color: first of the left boundary's color, then of the right one's.
    std::array<float, 2> nearest_of_color{};
};

/// What the color of a cone says; all 0 if that is unknown.
struct ConeSide {
    std::array<float, 2> of_side{};  ///< probability that it stands on the left (blue), on the right (yellow)
    float orange = 0.0F;             ///< that it is a small or a big orange one

    /// Color evidence, from -1 (color of the other side) to 1 (color of that side).
    [[nodiscard]] float speaks_for(Side side) const { return of_side[side] - of_side[opposite(side)]; }
    /// The probability that the color is unknown.
    [[nodiscard]] float unknown() const {
        return std::max(0.0F, 1.0F - of_side[kLeft] - of_side[kRight] - orange);
    }
};

/// The cones of a scene as the search sees them: in the frame of the car (x ahead, y to the left), ordered by
/// x, then y, then id, so that neither the order of the cones in the scene nor, unless two lie at one place,
/// their ids make a difference. The ways between them are found when first asked for. Reuses the memory of
/// the map before.
class FrontMap {
  public:
    static constexpr std::size_t kFewEdges = 12;   ///< a cone that has fewer looks farther
    static constexpr std::size_t kMaxEdges = 160;  ///< from a cone, the shortest ones

    /// Its time is the budget's. A map is whole only if the budget is not spent.
    void build(const Scene& scene, SearchBudget& budget);
    void build(const Scene& scene) {
        SearchBudget unlimited;
        build(scene, unlimited);
    }

    [[nodiscard]] std::size_t size() const { return positions_.size(); }
    [[nodiscard]] const Point& position(Vertex cone) const { return positions_[cone]; }
    /// Index in the scene.
    [[nodiscard]] std::size_t scene_index(Vertex cone) const { return order_[cone]; }
    /// Cones with x in [low, high] are those from the first to the second.
    [[nodiscard]] std::pair<Vertex, Vertex> ahead_between(double low_m, double high_m) const;
    /// Distance from the car of the farthest cone that has another one within kMaxSegment_m: about
    /// as far as the car sees. A cone far from all others does not count, unless every cone is
    /// alone.
    [[nodiscard]] double view_radius_m() const { return view_radius_m_; }

    /// Whether any cone may have a color. If none has, all color features are 0.
    [[nodiscard]] bool has_colors() const { return has_colors_; }
    /// Precondition: has_colors.
    [[nodiscard]] const ConeSide& color(Vertex cone) const { return colors_[cone]; }
    /// Mean probability that a cone has the color of a side.
    [[nodiscard]] float color_share() const { return color_share_; }
    /// Whether neighbouring cones have the same color: over the colored cones, the mean of the product of the
    /// color evidence of the cone and of the nearest other one within kShortSegment_m, from -1 to 1. About 0
    /// for random colors.
    [[nodiscard]] float color_consistency() const { return color_consistency_; }

    /// Whether the place of any cone is uncertain.
    [[nodiscard]] bool has_spread() const { return has_spread_; }
    /// Variance of the position of a cone along a unit vector [m^2]; 0 where nothing is known of it.
    [[nodiscard]] double variance_m2(Vertex cone, const Point& direction) const {
        return has_spread_ ? spread_[cone].along_m2(direction) : 0.0;
    }
    /// The mean of it over all directions.
    [[nodiscard]] double variance_m2(Vertex cone) const {
        return has_spread_ ? 0.5 * (spread_[cone].xx_m2 + spread_[cone].yy_m2) : 0.0;
    }
    /// Standard deviation of the distance of two cones [m]; 0 where they stand at one place.
    [[nodiscard]] double spread_between_m(Vertex a, Vertex b) const;

    /// The ways from a cone of at most kMaxSegment_m, the shortest first; where they are fewer than
    /// kFewEdges, as many of at most kMaxLengthAmongFew_m. Cones at the same place are not joined. Stays
    /// valid until the next `build`.
    [[nodiscard]] std::span<const FrontEdge> edges(Vertex from) {
        if (places_[from].count == kNotAsked) find_edges(from);
        const Place& place = places_[from];
        if (place.count == 0) return {};
        return {edge_at(place.first), place.count};
    }
    /// Logarithm of the number of ways of at most kShortSegment_m, with the cone itself, minus 1.5: about 0
    /// on average.
    [[nodiscard]] float density(Vertex cone) {
        if (places_[cone].count == kNotAsked) find_edges(cone);
        return places_[cone].density;
    }
    /// Whether any cone asked for so far has more ways than `edges` gives.
    [[nodiscard]] bool left_out_edges() const { return left_out_edges_; }
    /// `edge`: place in edges(from).
    [[nodiscard]] const EdgeNeighbourhood& neighbourhood(Vertex from, std::size_t edge);

    /// Memory that grows with the ways that were asked for [bytes].
    [[nodiscard]] std::size_t memory_bytes() const;

  private:
    struct Place {
        std::size_t first;
        std::uint32_t count;
        float density = 0.0F;
    };
    static constexpr std::uint32_t kNotAsked = ~std::uint32_t{0};
    static constexpr std::size_t kEdgesPerBlock = 4096;

    [[nodiscard]] FrontEdge* edge_at(std::size_t place) {
        return &blocks_[place / kEdgesPerBlock][place % kEdgesPerBlock];
    }
    void find_edges(Vertex from);
    void find_view_radius(SearchBudget& budget);
    [[nodiscard]] bool is_alone(Vertex cone, SearchBudget& budget) const;
    [[nodiscard]] EdgeNeighbourhood find_neighbourhood(Vertex from, std::size_t edge);
    void take_colors(const Scene& scene, SearchBudget& budget);
    void take_spread(const Scene& scene);
    [[nodiscard]] Vertex nearest_colored(Vertex cone, SearchBudget& budget) const;

    std::vector<Point> positions_;
    std::vector<std::uint32_t> order_;
    std::vector<Place> places_;
    // In blocks, so that spans stay valid while more ways are computed.
    std::vector<std::vector<FrontEdge>> blocks_;
    std::vector<EdgeNeighbourhood> neighbourhoods_;
    std::vector<FrontEdge> found_;
    std::size_t used_ = 0;
    double view_radius_m_ = 0.0;
    bool left_out_edges_ = false;
    bool has_colors_ = false;
    float color_share_ = 0.0F;
    float color_consistency_ = 0.0F;
    std::vector<ConeSide> colors_;  ///< not updated if no cone has a color
    bool has_spread_ = false;
    std::vector<PositionCovariance> spread_;  ///< in the frame of the car; not updated if there is none
};

}  // namespace conelane
