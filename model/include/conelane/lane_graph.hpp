#pragma once

#include "conelane/lane.hpp"
#include "conelane/scene.hpp"

#include <cstddef>
#include <optional>
#include <vector>

namespace conelane {

/// An undirected edge between two cones, as indices into Scene::cones, smaller one first.
struct Edge {
    std::size_t i;
    std::size_t j;

    auto operator<=>(const Edge&) const = default;
};
/// The edge between two distinct cones in either order.
[[nodiscard]] inline Edge make_edge(std::size_t a, std::size_t b) {
    return a < b ? Edge{a, b} : Edge{b, a};
}

/// A set of edges in ascending order: what an RLD solver answers. It is a lane graph in the sense of the
/// paper's definition 1 only if `paths` gives exactly two paths.
struct LaneGraph {
    std::vector<Edge> edges;

    bool operator==(const LaneGraph&) const = default;
};

/// The simple paths that the edges form, each as cone indices from the end with the smaller index, ordered by
/// that index. Nothing if the edges hold a cycle, a loop, an edge twice, a cone of degree above two or an
/// index not below `cone_count`.
[[nodiscard]] std::optional<std::vector<std::vector<std::size_t>>> paths(const LaneGraph& graph,
                                                                         std::size_t cone_count);

/// The lane whose boundaries are the two paths. Each path starts at the end nearer to the car; left is the
/// path whose point nearest to the car lies farther to the left of the car's axis. Ties: the first of
/// `paths` is left; the end of smaller index starts. Nothing unless the graph is exactly two simple paths.
[[nodiscard]] std::optional<Lane> to_lane(const LaneGraph& graph, const Scene& scene);

/// A lane graph of one scene as edges of the next. Cones with the same id are the same; an edge with a cone
/// that the next scene does not have is left out. Precondition: the graph's indices are below the cone count
/// of `previous`.
[[nodiscard]] LaneGraph map_by_cone_id(const Scene& previous, const LaneGraph& graph, const Scene& next);

}  // namespace conelane
