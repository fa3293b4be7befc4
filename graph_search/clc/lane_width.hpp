#pragma once

#include "graph_search/shared/search_graph.hpp"

#include <array>

namespace conelane {

/// The widths W(L, R) of equation (12) of the CLC paper [m], by query: distance of each vertex and each
/// segment of a boundary from the nearest point of the other boundary.
struct LaneWidths {
    std::array<std::vector<double>, 2> of_vertex_m;   ///< by side, one for each vertex
    std::array<std::vector<double>, 2> of_segment_m;  ///< by side, one for each segment
};

/// Equations (8) to (12) as printed, each query by itself. A boundary may be a single point; closed ones also
/// have the segment from the last vertex to the first. Precondition: no boundary is empty.
[[nodiscard]] LaneWidths lane_widths(std::span<const Point> left, std::span<const Point> right,
                                     bool closed = false);

/// A boundary as coordinate arrays. Segment i leads from vertex i to vertex i + 1.
struct BoundaryArrays {
    std::vector<double> x, y;    ///< of the vertices
    std::vector<double> dx, dy;  ///< of the segments, end minus begin
    std::vector<double> inverse_squared_length;
    std::size_t size = 0;  ///< vertices in use
    /// Padding of the arrays, so that loops may end in whole steps.
    static constexpr std::size_t kSpare = 8;

    void push(const Point& point);
    void pop() { --size; }
    [[nodiscard]] Point vertex(std::size_t i) const { return {x[i], y[i]}; }
    [[nodiscard]] Segment segment(std::size_t i) const { return {vertex(i), vertex(i + 1)}; }
};

/// Lane width while boundaries grow vertex by vertex and shrink again: the purpose of Algorithm 3.
///
/// Algorithm 3 as printed fixes every matching before the first one (in lexicographic order) that meets an
/// end of a boundary, and never revises it. That is not what equations (11) to (13) define: a later segment
/// may come nearer to an early query (tests/graph_search/clc/lane_width_test.cpp has an example). (21) and
/// (22) do hold: extending the other boundary never makes a width larger, and extending its own boundary does
/// not change it. So each query keeps its width so far, and a new segment is measured once against every
/// query and every old segment. It follows that these properties are final:
/// - a width not above w_min stays so;
/// - a width below w_max stays below;
/// - a width of w_max or more changes only if the *other* boundary is extended.
/// The widths equal those of `lane_widths` after every step as long as the boundaries have no point in
/// common; lane_constraints checks this before it measures.
class OnlineLaneWidth {
  public:
    /// What the constraint C_width, equation (13), needs of the lane.
    struct State {
        double narrowest_squared = std::numeric_limits<double>::infinity();  ///< [m^2]
        /// By side: vertices whose width is w_max or more. Segments need no count: no segment is farther from
        /// the other boundary than its ends.
        std::array<std::uint32_t, 2> too_wide{0, 0};
        /// Some vertex with a width of w_max or more was passed by both boundaries: it is not the last of its
        /// side, and the point nearest to it is not the end of the other. The paper calls these violations
        /// fixed.
        bool too_wide_behind = false;
    };

    /// Empties the lane and starts it with one point a side.
    void reset(const Point& left, const Point& right, double w_max_m);
    /// Precondition: the new segment has a length and meets no segment of the other boundary.
    void push(Side side, const Point& point);
    /// Adds a vertex without measuring, for a lane that cannot become feasible: until it is popped again, the
    /// state stays unchanged and widths must not be read.
    void push_unmeasured(Side side, const Point& point);
    void pop(Side side);

    [[nodiscard]] const State& state() const { return states_.back(); }
    [[nodiscard]] const BoundaryArrays& boundary(Side side) const { return boundaries_[side]; }
    /// Squares of the widths at the vertices of a side.
    [[nodiscard]] std::span<const double> squared_vertex_widths_m2(Side side) const {
        return {rows_[side].vertex_squared.data() + rows_[side].begins.back(), boundaries_[side].size};
    }
    /// Variance of all widths, those of vertices and those of segments [m^2].
    [[nodiscard]] double variance() const;

  private:
    /// Widths of one side's queries, a row for each length of the other boundary, one after the other. The
    /// last row is in use: a push on the other side starts a new row, a push on its own side appends to it,
    /// and undoing a push drops the end.
    struct Rows {
        std::vector<double> vertex_squared;   ///< [m^2]
        std::vector<double> segment_squared;  ///< [m^2]; entry i: the segment that ends at vertex i
        std::vector<std::int64_t> at_end;     ///< 1 if the last vertex of the other side is nearest, else 0
        std::vector<std::size_t> begins;

        void make_room(std::size_t size);
    };

    std::array<BoundaryArrays, 2> boundaries_;
    std::array<Rows, 2> rows_;
    std::vector<State> states_;
    std::vector<double> to_new_segment_;  ///< squared distances from the other side's vertices
    std::vector<double> foot_;           ///< where on the new segment these distances are attained, in [0, 1]
    std::vector<double> to_new_vertex_;  ///< squared distances from the other side's segments
    double squared_w_max_ = 0.0;
};

}  // namespace conelane
