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
    double distance_m;
};

/// By side, those within the largest radius.
std::array<std::vector<Candidate>, 2> candidates(const Scene& scene, const StartVertexRules& rules) {
    std::array<std::vector<Candidate>, 2> by_side;
    for (std::size_t i = 0; i < scene.cones.size(); ++i) {
        const Point& position = scene.cones[i].position;
        const Candidate candidate{static_cast<Vertex>(i), scene.pose.ahead_m(position),
                                  scene.pose.left_m(position), (position - scene.pose.position).norm()};
        if (candidate.distance_m > rules.largest_radius_m) continue;
        if (candidate.left_m > 0.0) by_side[kLeft].push_back(candidate);
        if (candidate.left_m < 0.0) by_side[kRight].push_back(candidate);
    }
    return by_side;
}

struct RankedPair {
    double cost_m;
    double distance_m;  ///< of the farther vertex
    StartPair pair;
};

}  // namespace

StartPairMeasures start_pair_measures(const Scene& scene, StartPair pair) {
    const Point& left = scene.cones[pair.left].position;
    const Point& right = scene.cones[pair.right].position;
    return {std::hypot(scene.pose.ahead_m(left) - scene.pose.ahead_m(right),
                       scene.pose.left_m(left) + scene.pose.left_m(right)),
            std::max((left - scene.pose.position).norm(), (right - scene.pose.position).norm())};
}

std::vector<StartPair> start_pairs(const Scene& scene, std::size_t count, const StartVertexRules& rules) {
    const auto [left, right] = candidates(scene, rules);
    std::vector<RankedPair> pairs;
    for (const Candidate& l : left) {
        for (const Candidate& r : right) {
            const double apart_m = std::hypot(l.ahead_m - r.ahead_m, l.left_m - r.left_m);
            if (apart_m <= rules.w_min_m || apart_m >= rules.w_max_m) continue;
            const StartPair pair{l.vertex, r.vertex};
            const auto [asymmetry_m, distance_m] = start_pair_measures(scene, pair);
            pairs.push_back({asymmetry_m + rules.distance_weight * distance_m, distance_m, pair});
        }
    }
    double radius_m = rules.radius_m;
    const auto inside = [&](const RankedPair& pair) { return pair.distance_m <= radius_m; };
    while (radius_m < rules.largest_radius_m &&
           static_cast<std::size_t>(std::ranges::count_if(pairs, inside)) < count) {
        radius_m = std::min(radius_m + rules.radius_growth_m, rules.largest_radius_m);
    }
    std::erase_if(pairs, [&](const RankedPair& pair) { return !inside(pair); });
    std::ranges::sort(pairs, {}, [](const RankedPair& pair) {
        // Unordered in the two vertices, so that a mirrored scene ranks alike.
        const auto [low, high] = std::minmax(pair.pair.left, pair.pair.right);
        return std::tuple(pair.cost_m, low, high);
    });
    std::vector<StartPair> best;
    for (const RankedPair& ranked : pairs) {
        if (best.size() == count) break;
        best.push_back(ranked.pair);
    }
    return best;
}

}  // namespace conelane
