#include "graph_search/clc/start_vertices.hpp"

#include <tuple>
#include <utility>

namespace conelane {

StartPairMeasures start_pair_measures(const Scene& scene, StartPair pair) {
    const Point heading = scene.pose.heading();
    const Point left = scene.cones[pair.left].position - scene.pose.position;
    const Point right = scene.cones[pair.right].position - scene.pose.position;
    const double left_ahead_m = heading.dot(left);
    const double right_ahead_m = heading.dot(right);
    const double left_side_m = cross(heading, left);
    const double right_side_m = -cross(heading, right);
    return {.asymmetry_m = std::hypot(left_ahead_m - right_ahead_m, left_side_m - right_side_m),
            .distance_m = std::max(left.norm(), right.norm()),
            .lead_m = std::abs(left_ahead_m - right_ahead_m),
            .shift_m = std::abs(left_side_m - right_side_m),
            .nearest_side_m = std::min(left_side_m, right_side_m),
            .nearest_ahead_m = std::min(left_ahead_m, right_ahead_m),
            .farthest_ahead_m = std::max(left_ahead_m, right_ahead_m)};
}

void StartPairs::find(const Scene& scene, const StartVertexRules& rules, const LaneBounds& bounds) {
    rules_ = rules;
    find_candidates(scene);
    ranked_.clear();
    for (const Candidate& left : candidates_[kLeft]) {
        for (const Candidate& right : candidates_[kRight]) {
            const double apart_m = std::hypot(left.ahead_m - right.ahead_m, left.left_m - right.left_m);
            if (apart_m <= bounds.w_min_m || apart_m >= bounds.w_max_m) continue;
            const StartPair pair{left.vertex, right.vertex};
            const StartPairMeasures measures = start_pair_measures(scene, pair);
            ranked_.push_back({pair, measures.asymmetry_m + rules.distance_weight * measures.distance_m,
                               measures.distance_m});
        }
    }
    std::ranges::sort(ranked_, {}, [](const RankedStartPair& pair) {
        // Symmetric in the two vertices, so that a mirrored scene gets the same order.
        const auto [low, high] = std::minmax(pair.pair.left, pair.pair.right);
        return std::tuple(pair.cost_m, low, high);
    });
}

void StartPairs::find_candidates(const Scene& scene) {
    const Point heading = scene.pose.heading();
    for (std::vector<Candidate>& side : candidates_) side.clear();
    for (std::size_t i = 0; i < scene.cones.size(); ++i) {
        const Point offset = scene.cones[i].position - scene.pose.position;
        const double distance_m = offset.norm();
        if (distance_m > rules_.largest_radius_m) continue;
        const Candidate candidate{static_cast<Vertex>(i), distance_m, heading.dot(offset),
                                  cross(heading, offset)};
        if (candidate.left_m > 0.0) candidates_[kLeft].push_back(candidate);
        if (candidate.left_m < 0.0) candidates_[kRight].push_back(candidate);
    }
    complete_ = true;
    for (std::vector<Candidate>& side : candidates_) {
        if (side.size() <= kMaxVertices) continue;
        complete_ = false;
        const auto order = [](const Candidate& candidate) {
            return std::pair(candidate.distance_m, candidate.vertex);
        };
        std::ranges::nth_element(side, side.begin() + kMaxVertices, {}, order);
        side.resize(kMaxVertices);
    }
}

void StartPairs::best(std::size_t count, std::vector<StartPair>& pairs) const {
    double radius_m = rules_.radius_m;
    const auto inside = [&](const RankedStartPair& pair) { return pair.distance_m <= radius_m; };
    while (radius_m < rules_.largest_radius_m &&
           static_cast<std::size_t>(std::ranges::count_if(ranked_, inside)) < count) {
        radius_m = std::min(radius_m + rules_.radius_growth_m, rules_.largest_radius_m);
    }
    pairs.clear();
    for (const RankedStartPair& pair : ranked_) {
        if (pairs.size() == count) break;
        if (inside(pair)) pairs.push_back(pair.pair);
    }
}

std::vector<StartPair> start_pairs(const Scene& scene, std::size_t count, const StartVertexRules& rules,
                                   const LaneBounds& bounds) {
    StartPairs all;
    all.find(scene, rules, bounds);
    std::vector<StartPair> pairs;
    all.best(count, pairs);
    return pairs;
}

}  // namespace conelane
