#include "graph_search/candidate_search.hpp"

#include "model/invalid_input.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>

namespace conelane {
namespace {

void require(bool valid, const std::string& key, const std::string& reason) {
    if (!valid) throw InvalidInput(key, reason);
}

SearchBudget::Clock::time_point deadline(double time_limit_ms) {
    using Clock = SearchBudget::Clock;
    const Clock::time_point now = Clock::now();
    const std::chrono::duration<double, std::milli> limit(std::max(time_limit_ms, 0.0));
    // Written so that NaN and what the clock cannot hold mean no limit.
    if (!(limit < std::chrono::hours(24))) return Clock::time_point::max();
    return now + std::chrono::duration_cast<Clock::duration>(limit);
}

/// What is left of a lane: from the first cone of each side that is still seen and ahead of the car, as far
/// as every cone is seen. Nothing where a side has none left.
std::optional<PathPairVertices> still_ahead(const Lane& lane, const Scene& scene) {
    std::unordered_map<ConeId, Vertex> vertex_of;  // for look-up only
    for (std::size_t i = 0; i < scene.cones.size(); ++i) {
        vertex_of.emplace(scene.cones[i].id, static_cast<Vertex>(i));
    }
    PathPairVertices rest;
    for (const Side side : {kLeft, kRight}) {
        for (const ConeId id : side == kLeft ? lane.left : lane.right) {
            const auto found = vertex_of.find(id);
            const bool seen = found != vertex_of.end();
            if (rest[side].empty() &&
                (!seen || scene.pose.ahead_m(scene.cones[found->second].position) < 0.0)) {
                continue;
            }
            if (!seen) break;
            rest[side].push_back(found->second);
        }
        if (rest[side].empty()) return std::nullopt;
    }
    if (rest[kLeft].front() == rest[kRight].front()) return std::nullopt;
    return rest;
}

}  // namespace

void validate(const CandidateSearchOptions& options) {
    const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
    require(options.iteration_limit > 0, "iteration_limit", "must be positive");
    require(options.starting_pairs > 0, "starting_pairs", "must be positive");
    require(options.beam_width > 0, "beam_width", "must be positive");
    if (options.step_scores) validate(*options.step_scores);
    require(positive(options.d_max_m), "d_max", "must be positive");
    require(options.bounds.phi_max_rad > 0.0 && options.bounds.phi_max_rad <= std::numbers::pi, "phi_max",
            "must be in (0, pi]");
    require(std::isfinite(options.bounds.w_min_m) && options.bounds.w_min_m >= 0.0, "w_min",
            "must not be negative");
    require(std::isfinite(options.bounds.w_max_m) && options.bounds.w_max_m > options.bounds.w_min_m, "w_max",
            "must be above w_min");
    require(positive(options.start.radius_m), "radius", "must be positive");
    require(positive(options.start.radius_growth_m), "radius_growth", "must be positive");
    require(std::isfinite(options.start.largest_radius_m) &&
                options.start.largest_radius_m >= options.start.radius_m,
            "largest_radius", "must not be below radius");
    require(std::isfinite(options.start.distance_weight) && options.start.distance_weight >= 0.0,
            "distance_weight", "must not be negative");
    require(std::isfinite(options.next_vertex_distance_weight) && options.next_vertex_distance_weight >= 0.0,
            "next_vertex_distance_weight", "must not be negative");
}

CandidateSearch::CandidateSearch(const CandidateSearchOptions& options) : options_(options) {
    validate(options);
    options_.start.w_min_m = options.bounds.w_min_m;
    options_.start.w_max_m = options.bounds.w_max_m;
    rules_.bounds = options.bounds;
    rules_.d_max_m = options.d_max_m;
    rules_.width_backtracking = options.width_backtracking;
    rules_.next_vertex_distance_weight = options.next_vertex_distance_weight;
}

CandidateSearch::Report CandidateSearch::run(const Scene& scene, const Request& request) {
    Report report;
    rules_.with_features = request.with_features;
    budget_ = SearchBudget{};
    budget_.deadline = deadline(request.time_limit_ms);
    points_.clear();
    for (const Cone& cone : scene.cones) points_.push_back(cone.position);
    graph_.build(points_, options_.d_max_m, options_.edge_rule);
    pairs_.clear();

    find_seeds(scene, request.last_lane);
    for (std::size_t i = 0; i < seeds_.size(); ++i) {
        run_from(seeds_[i], i + 1 == seeds_.size(), scene, report);
        seeds_[i].found_end = pairs_.found().size();
    }
    if (rules_.with_features) add_scene_features(scene);
    report.iterations = budget_.iterations;
    report.out_of_time = budget_.out_of_time;
    return report;
}

void CandidateSearch::find_seeds(const Scene& scene, const Lane* last_lane) {
    seeds_.clear();
    const auto add_guide = [&](const std::optional<PathPairVertices>& guide) {
        if (!guide) return;
        const bool is_known =
            std::ranges::any_of(seeds_, [&](const Seed& seed) { return seed.guide == *guide; });
        if (!is_known) seeds_.push_back({{(*guide)[kLeft].front(), (*guide)[kRight].front()}, *guide, 0});
    };
    const std::vector<RankedStartPair> starts = ranked_start_pairs(scene, options_.start);
    if (last_lane != nullptr) add_guide(still_ahead(*last_lane, scene));
    if (options_.step_scores) add_guide(beam_lane(scene, starts));
    const std::size_t guided = seeds_.size();
    for (const StartPair& start : start_pairs(starts, options_.starting_pairs, options_.start)) {
        const bool is_met = std::any_of(seeds_.begin(), seeds_.begin() + static_cast<std::ptrdiff_t>(guided),
                                        [&](const Seed& seed) { return seed.start == start; });
        if (!is_met) seeds_.push_back({start, {}, 0});
    }
}

std::optional<PathPairVertices> CandidateSearch::beam_lane(const Scene& scene,
                                                           std::span<const RankedStartPair> starts) {
    beam_.start(graph_, scene, start_pairs(starts, starts.size(), options_.start), *options_.step_scores,
                options_.bounds, options_.beam_width);
    const std::size_t best = beam_.run();
    if (best == LaneBeam::kNone) return std::nullopt;
    return beam_.vertices(best);
}

void CandidateSearch::run_from(const Seed& seed, bool is_last, const Scene& scene, Report& report) {
    const std::int64_t left = options_.iteration_limit - budget_.iterations;
    budget_.iteration_limit = budget_.iterations + (is_last ? left : left - left / 2);
    const std::int64_t limit = budget_.iteration_limit;
    const bool twice = options_.second_search_discrepancies > 0;
    if (twice) budget_.iteration_limit -= (limit - budget_.iterations) / 2;
    const bool complete =
        enumeration_.run(graph_, seed.start, scene.pose.heading(), rules_, budget_, pairs_, seed.guide);
    budget_.iteration_limit = limit;
    if (twice && !complete) {
        EnumerationRules narrow = rules_;
        narrow.most_discrepancies = options_.second_search_discrepancies;
        (void)enumeration_.run(graph_, seed.start, scene.pose.heading(), narrow, budget_, pairs_, seed.guide);
    }
    report.complete &= complete;
}

void CandidateSearch::add_scene_features(const Scene& scene) {
    const std::span<LaneFeatures> features = pairs_.features();
    double longest_m = 0.0;
    for (const LaneFeatures& lane : features) longest_m = std::max(longest_m, lane[0]);
    std::size_t i = 0;
    for (const Seed& seed : seeds_) {
        const StartPairMeasures measures = start_pair_measures(scene, seed.start);
        const std::array<double, kLaneFeatureCount - kStartPlaceFeatures> of_start{
            measures.lead_m, measures.shift_m, measures.nearest_side_m, measures.nearest_ahead_m,
            measures.farthest_ahead_m};
        for (; i < seed.found_end; ++i) {
            LaneFeatures& lane = features[i];
            lane[kLongestShareFeature] = lane[0] / longest_m;
            lane[kStartAsymmetryFeature] = measures.asymmetry_m;
            lane[kStartDistanceFeature] = measures.distance_m;
            lane[kConesFeature] = static_cast<double>(scene.cones.size());
            std::ranges::copy(of_start, lane.begin() + kStartPlaceFeatures);
        }
    }
}

Lane CandidateSearch::lane(const PathPair& pair, const Scene& scene) const {
    const PathPairVertices vertices = pairs_.vertices(pair);
    Lane lane;
    for (const Vertex vertex : vertices[kLeft]) lane.left.push_back(scene.cones[vertex].id);
    for (const Vertex vertex : vertices[kRight]) lane.right.push_back(scene.cones[vertex].id);
    lane.closed = pair.closed;
    return lane;
}

}  // namespace conelane
