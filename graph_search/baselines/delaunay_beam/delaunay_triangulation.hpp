#pragma once

#include "graph_search/shared/search_budget.hpp"
#include "graph_search/shared/search_graph.hpp"
#include "model/geometry.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

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

}  // namespace conelane
