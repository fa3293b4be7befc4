#include "graph_search/start_vertices.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace conelane {
namespace {

struct Candidate {
    Vertex vertex;
    double ahead_m;
    double left_m;
};

/// By side, those within the largest radius.
std::array<std::vector<Candidate>, 2> candidates(const Scene& scene, const StartVertexRules& rules) {
    std::array<std::vector<Candidate>, 2> by_side;
    const Point heading = scene.pose.heading();
    for (std::size_t i = 0; i < scene.cones.size(); ++i) {
        const Point offset = scene.cones[i].position - scene.pose.position;
        if (offset.norm() > rules.largest_radius_m) continue;
        const Candidate candidate{static_cast<Vertex>(i), heading.dot(offset), cross(heading, offset)};
        if (candidate.left_m > 0.0) by_side[kLeft].push_back(candidate);
        if (candidate.left_m < 0.0) by_side[kRight].push_back(candidate);
    }
    return by_side;
}

}  // namespace

StartPairMeasures start_pair_measures(const Scene& scene, StartPair pair) {
    const Point heading = scene.pose.heading();
    const Point left = scene.cones[pair.left].position - scene.pose.position;
    const Point right = scene.cones[pair.right].position - scene.pose.position;
    const double left_ahead_m = heading.dot(left);
    const double right_ahead_m = heading.dot(right);
    const double left_side_m = cross(heading, left);
    const double right_side_m = -cross(heading, right);
    return {std::hypot(left_ahead_m - right_ahead_m, left_side_m - right_side_m),
            std::max(left.norm(), right.norm()),
            std::abs(left_ahead_m - right_ahead_m),
            std::abs(left_side_m - right_side_m),
            std::min(left_side_m, right_side_m),
            std::min(left_ahead_m, right_ahead_m),
            std::max(left_ahead_m, right_ahead_m)};
}

std::vector<RankedStartPair> ranked_start_pairs(const Scene& scene, const StartVertexRules& rules) {
    const auto [left, right] = candidates(scene, rules);
    std::vector<RankedStartPair> pairs;
    for (const Candidate& l : left) {
        for (const Candidate& r : right) {
            const double apart_m = std::hypot(l.ahead_m - r.ahead_m, l.left_m - r.left_m);
            if (apart_m <= rules.w_min_m || apart_m >= rules.w_max_m) continue;
            const StartPair pair{l.vertex, r.vertex};
            const StartPairMeasures measures = start_pair_measures(scene, pair);
            pairs.push_back({pair, measures.asymmetry_m + rules.distance_weight * measures.distance_m,
                             measures.distance_m});
        }
    }
    std::ranges::sort(pairs, {}, [](const RankedStartPair& pair) {
        // Unordered in the two vertices, so that a mirrored scene ranks alike.
        const auto [low, high] = std::minmax(pair.pair.left, pair.pair.right);
        return std::tuple(pair.cost_m, low, high);
    });
    return pairs;
}

std::vector<StartPair> start_pairs(std::span<const RankedStartPair> ranked, std::size_t count,
                                   const StartVertexRules& rules) {
    double radius_m = rules.radius_m;
    const auto inside = [&](const RankedStartPair& pair) { return pair.distance_m <= radius_m; };
    while (radius_m < rules.largest_radius_m &&
           static_cast<std::size_t>(std::ranges::count_if(ranked, inside)) < count) {
        radius_m = std::min(radius_m + rules.radius_growth_m, rules.largest_radius_m);
    }
    std::vector<StartPair> best;
    for (const RankedStartPair& pair : ranked) {
        if (best.size() == count) break;
        if (inside(pair)) best.push_back(pair.pair);
    }
    return best;
}

std::vector<StartPair> start_pairs(const Scene& scene, std::size_t count, const StartVertexRules& rules) {
    return start_pairs(ranked_start_pairs(scene, rules), count, rules);
}

}  // namespace conelane
