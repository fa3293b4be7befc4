#pragma once

#include "conelane/lane_detector.hpp"
#include "graph_search/shared/parameter_field.hpp"
#include "graph_search/shared/search_graph.hpp"

namespace conelane {

/// The Delaunay triangulation of points, rounded to a grid that divides their extent by 2^30. On that grid
/// every predicate is exact. Of points on the same place of the grid only the first, by index, is used.
/// Points are inserted from left to right; each one is joined to the visible part of the hull, then edges are
/// flipped until every circumcircle is empty (Lawson).
class DelaunayTriangulation {
  public:
    /// A side of a triangle, counter-clockwise: sides 3t, 3t + 1 and 3t + 2 are those of triangle t.
    using HalfEdge = std::uint32_t;
    static constexpr HalfEdge kNone = std::numeric_limits<HalfEdge>::max();

    /// Returns false if the budget is spent: then there are no triangles. Reuses memory from call to call.
    [[nodiscard]] bool build(std::span<const Point> points, SearchBudget& budget);

    /// Three for each triangle; none if all points are on one line.
    [[nodiscard]] std::size_t half_edge_count() const { return origin_.size(); }
    [[nodiscard]] Vertex origin(HalfEdge side) const { return sites_[origin_[side]].vertex; }
    [[nodiscard]] Vertex target(HalfEdge side) const { return origin(next(side)); }
    /// The same side seen from the triangle beyond it; kNone on the hull.
    [[nodiscard]] HalfEdge twin(HalfEdge side) const { return twin_[side]; }
    [[nodiscard]] static HalfEdge next(HalfEdge side) { return side % 3 == 2 ? side - 2 : side + 1; }

  private:
    /// The place on the grid.
    struct Site {
        std::int64_t x;
        std::int64_t y;
        Vertex vertex;
        auto operator<=>(const Site&) const = default;
    };
    using SiteIndex = std::uint32_t;

    void place_sites(std::span<const Point> points);
    void join_first_triangles(SiteIndex apex);
    void insert(SiteIndex site);
    /// Flips edges, beginning with those in `unsettled_`. Each of these is opposite to the site inserted
    /// last.
    std::size_t settle();
    HalfEdge add_triangle(SiteIndex a, SiteIndex b, SiteIndex c);
    void join(HalfEdge side, HalfEdge twin);

    std::vector<Site> sites_;  ///< ascending
    std::vector<SiteIndex> origin_;
    std::vector<HalfEdge> twin_;
    /// For sites on the hull: the two neighbours there and the half-edge to the next one, counter-clockwise.
    std::vector<SiteIndex> hull_next_;
    std::vector<SiteIndex> hull_previous_;
    std::vector<HalfEdge> hull_side_;
    std::vector<HalfEdge> unsettled_;
};

/// The cost of a path, relative to the squared relative error of its length, and the limits of the tree of
/// paths. The paper prints no values.
struct DelaunayBeamParameters {
    double w_turn = 0.2;          ///< weight of the squared largest turn [1/rad^2]
    double w_width_spread = 0.2;  ///< weight of the variance of the track width [1/m^2]
    double w_width = 0.1;         ///< weight of the squared error of the mean width [1/m^2]
    double w_spacing = 0.05;      ///< weight of the mean variance of both boundaries' spacing [1/m^2]
    double w_start = 0.01;        ///< weight of the squared distance to the first middle point [1/m^2]
    double expected_width_m = 4.0;
    double expected_length_m = 25.0;  ///< expected length of the path; no path is longer
    double widest_m = 7.0;            ///< longest edge that a path crosses
    double longest_spacing_m = 6.5;   ///< longest edge of a boundary
    double start_radius_m = 7.0;      ///< largest distance of the first middle point of a path

    // Not tuned: scenes are scored without colors, and a wider beam only takes longer.
    /// Weight of the mean probability that a cone has the color of the other side, in [0, 1000].
    double w_color = 1.0;
    /// Paths kept at each depth of the tree, in [1, 10000].
    std::size_t beam_width = 100;
};

/// The tuned numbers, in the order of files.
[[nodiscard]] std::span<const ParameterField<DelaunayBeamParameters>> delaunay_beam_fields();

/// Throws InvalidInput naming the first parameter that is out of its range.
void validate(const DelaunayBeamParameters& parameters);

/// The boundary estimation of the AMZ team (Kabzan et al., "AMZ Driverless: The Full Autonomous Racing
/// System", reference [4] of the CLC paper). The cones are triangulated (Delaunay). From the car on, a tree
/// of paths grows through the middle points of the edges, from triangle to triangle. The two ends of a
/// crossed edge are the cones of the boundaries there, so each triangle extends one boundary by one cone. At
/// each depth only the paths of the lowest cost are kept (beam search). The answer is the path of the lowest
/// cost of all: it turns little, its width and spacings vary little, its length is near the expected range
/// and, if colors are known, few of its cones have the wrong color. None of this is a constraint.
///
/// Two terms are added to the paper's: the error of the mean width (from the rules of the competition) and
/// the distance to the first middle point, since the car is seldom inside a triangle of the cones ahead.
///
/// A lane has at least two cones a side, each cone at most once. LaneAnswer::status: `none` if no path of the
/// whole tree is a lane; `stopped` by iterations if no lane was found but the beam left paths out. No state
/// is kept from scene to scene. Throws InvalidInput if a parameter is out of its range.
[[nodiscard]] std::unique_ptr<LaneDetector> make_delaunay_beam_detector(
    const DelaunayBeamParameters& parameters);

}  // namespace conelane
