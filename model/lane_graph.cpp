#include "conelane/lane_graph.hpp"

#include "model/geometry.hpp"

#include <array>
#include <limits>
#include <unordered_map>
#include <utility>

namespace conelane {

std::optional<std::vector<std::vector<std::size_t>>> paths(const LaneGraph& graph, std::size_t cone_count) {
    constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
    std::vector<std::array<std::size_t, 2>> neighbours(cone_count, {kNone, kNone});
    const auto connect = [&](std::size_t from, std::size_t to) {
        for (std::size_t& slot : neighbours[from]) {
            if (slot == kNone) {
                slot = to;
                return true;
            }
        }
        return false;
    };
    for (const Edge& edge : graph.edges) {
        if (edge.i >= cone_count || edge.j >= cone_count || edge.i == edge.j) return std::nullopt;
        if (!connect(edge.i, edge.j) || !connect(edge.j, edge.i)) return std::nullopt;
    }
    std::vector<std::vector<std::size_t>> result;
    std::vector<bool> visited(cone_count, false);
    std::size_t edges_walked = 0;
    for (std::size_t start = 0; start < cone_count; ++start) {
        const bool is_end = neighbours[start][0] != kNone && neighbours[start][1] == kNone;
        if (!is_end || visited[start]) continue;
        std::vector<std::size_t> path{start};
        visited[start] = true;
        for (std::size_t next = neighbours[start][0]; next != kNone;) {
            const std::size_t previous = path.back();
            path.push_back(next);
            visited[next] = true;
            ++edges_walked;
            const auto& [first, second] = neighbours[next];
            next = first == previous ? second : first;
        }
        result.push_back(std::move(path));
    }
    // Edges that are on no path lie on cycles.
    if (edges_walked != graph.edges.size()) return std::nullopt;
    return result;
}

std::optional<Lane> to_lane(const LaneGraph& graph, const Scene& scene) {
    auto boundaries = paths(graph, scene.cones.size());
    if (!boundaries || boundaries->size() != 2) return std::nullopt;

    std::array<double, 2> offset_left_m{};
    for (std::size_t side = 0; side < 2; ++side) {
        std::vector<std::size_t>& path = (*boundaries)[side];
        const auto distance = [&](std::size_t cone) {
            return (scene.cones[cone].position - scene.pose.position).squaredNorm();
        };
        if (distance(path.back()) < distance(path.front())) std::ranges::reverse(path);
        std::vector<Point> vertices;
        for (const std::size_t cone : path) vertices.push_back(scene.cones[cone].position);
        offset_left_m[side] = scene.pose.left_m(foot_on_polyline(scene.pose.position, vertices).point);
    }
    const std::size_t left = offset_left_m[0] >= offset_left_m[1] ? 0 : 1;
    Lane lane;
    for (const std::size_t cone : (*boundaries)[left]) lane.left.push_back(scene.cones[cone].id);
    for (const std::size_t cone : (*boundaries)[1 - left]) lane.right.push_back(scene.cones[cone].id);
    return lane;
}

LaneGraph map_by_cone_id(const Scene& previous, const LaneGraph& graph, const Scene& next) {
    std::unordered_map<ConeId, std::size_t> index_of;
    for (std::size_t cone = 0; cone < next.cones.size(); ++cone) index_of.emplace(next.cones[cone].id, cone);
    LaneGraph mapped;
    for (const Edge& edge : graph.edges) {
        const auto a = index_of.find(previous.cones[edge.i].id);
        const auto b = index_of.find(previous.cones[edge.j].id);
        if (a != index_of.end() && b != index_of.end())
            mapped.edges.push_back(make_edge(a->second, b->second));
    }
    std::ranges::sort(mapped.edges);
    return mapped;
}

}  // namespace conelane
