#pragma once

#include "graph_search/shared/search_graph.hpp"
#include "model/geometry.hpp"

#include <limits>

namespace conelane {

/// Within this distance of a segment, across it, a vertex lies beside the segment, ...
inline constexpr double kBeside_m = 1.2;
/// ... and within this one close to it [m].
inline constexpr double kClose_m = 0.6;

/// Vertices around a new segment of a boundary, from `tip` to `point`.
struct Neighbourhood {
    double inside =
        0.0;  ///< in the triangle with the last vertex of the other side, `facing`; its edges do not count
    double beside = 0.0;
    double close = 0.0;
    double closeness = 0.0;  ///< sum over those beside, weighted from 1 on the segment to 0
};

/// Counts among the neighbours of `vertex`, which should be an end of the segment. Vertices at `left_out` and
/// at `left_out_too` do not count as beside the segment.
[[nodiscard]] Neighbourhood neighbourhood(const SearchGraph& graph, Vertex vertex, const Point& tip,
                                          const Point& facing, const Point& point, const Point& left_out,
                                          const Point& left_out_too);
/// The same with all neighbours.
[[nodiscard]] inline Neighbourhood neighbourhood(const SearchGraph& graph, Vertex vertex, const Point& tip,
                                                 const Point& facing, const Point& point) {
    constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
    return neighbourhood(graph, vertex, tip, facing, point, {kNowhere, kNowhere}, {kNowhere, kNowhere});
}

}  // namespace conelane
