#include "model/near_edges.hpp"

#include <cmath>

namespace conelane {

bool come_closer(const MeasuredSegment& a, const MeasuredSegment& b, double limit_m) {
    if (!(limit_m > 0.0)) return false;
    const auto least = [](double x, double y) { return x < y ? x : y; };
    const Point ways[4] = {b.from - a.from, b.to - a.from, b.from - a.to, b.to - a.to};
    const auto squared_to_foot = [&](const Point& way, const MeasuredSegment& segment) {
        const double share = way.dot(segment.along) * segment.inverse_squared_length;
        return (way - least(std::max(0.0, share), 1.0) * segment.along).squaredNorm();
    };
    // If two segments do not cross, an end of one of them is nearest.
    const double squared = least(least(squared_to_foot(ways[0], a), squared_to_foot(ways[1], a)),
                                 least(squared_to_foot(-ways[0], b), squared_to_foot(-ways[2], b)));
    const auto between_ends_m = [&] {
        return std::sqrt(least(least(ways[0].squaredNorm(), ways[1].squaredNorm()),
                               least(ways[2].squaredNorm(), ways[3].squaredNorm())));
    };
    if (squared < limit_m * limit_m && between_ends_m() > std::sqrt(squared) + kTieTolerance) return true;
    // Segments that cross have distance 0, however far their ends are from the other segment.
    return cross(a.along, ways[0]) * cross(a.along, ways[1]) < 0.0 &&
           cross(b.along, ways[0]) * cross(b.along, ways[2]) < 0.0 && between_ends_m() > kTieTolerance;
}

NearEdges::NearEdges(const Scene& scene, std::span<const ProblemEdge> edges, double reach_m)
    : scene_(scene), edges_(edges), reach_m_(std::max(reach_m, 0.0)) {
    const std::size_t n = scene.cones.size();
    first_edge_.assign(n + 1, 0);
    for (const ProblemEdge& edge : edges) {
        ++first_edge_[edge.i + 1];
        const Point along = scene.cones[edge.j].position - scene.cones[edge.i].position;
        max_length_m_ = std::max(max_length_m_, along.norm());
    }
    for (std::size_t cone = 0; cone < n; ++cone) first_edge_[cone + 1] += first_edge_[cone];
    codes_.resize(n);
    is_gathered_.resize(n);
    cone_list_.resize(n);
    gathered_list_.resize(edges.size() + 1);
    near_list_.resize(edges.size() + 1);
}

/// An edge of the cone and an edge within its reach have all ends within two lengths plus the reach.
void NearEdges::gather(std::size_t cone) {
    around_ = cone;
    const double radius_m = 2.0 * max_length_m_ + reach_m_;
    const Point& centre = scene_.cones[cone].position;
    // Each entry is written, and overwritten unless the count grows: a branch is often mispredicted.
    std::size_t count = 0;
    for (std::size_t other = cone + 1; other < codes_.size(); ++other) {
        const bool is_near = (scene_.cones[other].position - centre).squaredNorm() <= radius_m * radius_m;
        is_gathered_[other] = is_near ? 1 : 0;
        cone_list_[count] = other;
        count += is_near ? 1 : 0;
    }
    cones_ = {cone_list_.data(), count};
    count = 0;
    for (const std::size_t from : cones_) {
        for (std::size_t e = first_edge_[from]; e < first_edge_[from + 1]; ++e) {
            gathered_list_[count] = e;
            count += is_gathered_[edges_[e].j];
        }
    }
    gathered_ = {gathered_list_.data(), count};
}

std::span<const std::size_t> NearEdges::after(std::size_t e) {
    const ProblemEdge& edge = edges_[e];
    if (edge.i != around_) gather(edge.i);
    const Point& from = scene_.cones[edge.i].position;
    const Point along = scene_.cones[edge.j].position - from;
    const double squared_length = along.squaredNorm();
    const double bound = reach_m_ * std::sqrt(squared_length);
    for (const std::size_t cone : cones_) {
        const Point way = scene_.cones[cone].position - from;
        const double left = cross(along, way);
        const double ahead = along.dot(way);
        codes_[cone] = (left > bound ? kLeft : 0U) | (left < -bound ? kRight : 0U) |
                       (ahead < -bound ? kBehind : 0U) | (ahead > squared_length + bound ? kAhead : 0U);
    }
    codes_[edge.j] = kOwn;
    std::size_t count = 0;
    for (const std::size_t other : gathered_) {
        const unsigned code_i = codes_[edges_[other].i];
        const unsigned code_j = codes_[edges_[other].j];
        near_list_[count] = other;
        count += ((code_i & code_j) | ((code_i | code_j) & kOwn)) == 0 ? 1 : 0;
    }
    return {near_list_.data(), count};
}

}  // namespace conelane
