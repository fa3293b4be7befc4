#pragma once

#include "graph_search/search_graph.hpp"

#include <span>
#include <utility>
#include <vector>

namespace conelane::experiments {

/// The edges of the Delaunay triangulation, an EdgeRule: section IV-B of the CLC paper, whose graph has too few
/// edges. It is the dual of the Voronoi diagram of the points, rounded to a grid that divides their extent by
/// 2^30. Of four and more points on an empty circle only the sides of their polygon are edges; of points that
/// fall on one place of the grid only the first has any.
[[nodiscard]] std::vector<std::pair<Vertex, Vertex>> delaunay_edges(std::span<const Point> points);

}  // namespace conelane::experiments
