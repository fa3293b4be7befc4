#pragma once

#include "graph_search/shared/search_graph.hpp"

namespace conelane {

/// Within this distance of a segment, across it, a vertex lies beside the segment, ...
inline constexpr double kBeside_m = 1.2;
/// ... and within this one close to it [m].
inline constexpr double kClose_m = 0.6;

/// A new segment of a boundary, from `tip` to `point`, and the last vertex of the other side.
struct NewSegment {
    Point tip;
    Point point;
    Point facing;
    bool leaves_ends_out = false;  ///< vertices at `point` and at `facing` do not count as beside it
};

/// Vertices around a new segment.
struct Neighbourhood {
    double inside = 0.0;  ///< in the triangle of its three points; the edges of the triangle do not count
    double beside = 0.0;
    double close = 0.0;
    double closeness = 0.0;  ///< sum over those beside, weighted from 1 on the segment to 0
};

/// Counts among the neighbours of `vertex`, which should be an end of the segment.
[[nodiscard]] Neighbourhood neighbourhood(const SearchGraph& graph, Vertex vertex, const NewSegment& added);

}  // namespace conelane
