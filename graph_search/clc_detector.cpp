#include "graph_search/clc_detector.hpp"

#include "graph_search/path_pair_enumeration.hpp"
#include "graph_search/search_graph.hpp"
#include "model/invalid_input.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace conelane {
namespace {

void require(bool valid, const std::string& key, const std::string& reason) {
    if (!valid) throw InvalidInput(key, reason);
}

void validate(const ClcOptions& options) {
    const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
    require(options.iteration_limit > 0, "iteration_limit", "must be positive");
    require(options.starting_pairs > 0, "starting_pairs", "must be positive");
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
}

SearchBudget::Clock::time_point deadline(double time_limit_ms) {
    using Clock = SearchBudget::Clock;
    const Clock::time_point now = Clock::now();
    const std::chrono::duration<double, std::milli> limit(std::max(time_limit_ms, 0.0));
    // Written so that NaN and what the clock cannot hold mean no limit.
    if (!(limit < std::chrono::hours(24))) return Clock::time_point::max();
    return now + std::chrono::duration_cast<Clock::duration>(limit);
}

class ClcDetector final : public LaneDetector {
  public:
    explicit ClcDetector(const ClcOptions& options) : options_(options) {
        options_.start.w_min_m = options.bounds.w_min_m;
        options_.start.w_max_m = options.bounds.w_max_m;
        rules_.bounds = options.bounds;
        rules_.d_max_m = options.d_max_m;
        rules_.width_backtracking = options.width_backtracking;
        rules_.with_features = options.ranking != nullptr;
    }

    LaneAnswer detect(const Scene& scene, const DetectionLimits& limits) override {
        SearchBudget budget;
        budget.deadline = deadline(limits.time_limit_ms);
        points_.clear();
        for (const Cone& cone : scene.cones) points_.push_back(cone.position);
        graph_.build(points_, options_.d_max_m);
        pairs_.clear();

        const std::vector<StartPair> starts = start_pairs(scene, options_.starting_pairs, options_.start);
        bool complete = true;
        for (std::size_t i = 0; i < starts.size(); ++i) {
            const std::int64_t left = options_.iteration_limit - budget.iterations;
            budget.iteration_limit = budget.iterations + (i + 1 < starts.size() ? left - left / 2 : left);
            complete &= enumeration_.run(graph_, starts[i], scene.pose.heading(), rules_, budget, pairs_);
        }

        LaneAnswer answer;
        answer.enumeration = Enumeration{budget.iterations, complete, {}};
        if (limits.keep_candidates) {
            for (const PathPair& pair : pairs_.found()) {
                answer.enumeration->candidates.push_back({to_lane(pair, scene), pair.iteration});
            }
        }
        if (!pairs_.found().empty()) {
            answer.status = LaneStatus::found;
            answer.lane = to_lane(best(), scene);
        } else {
            answer.status = budget.out_of_time ? LaneStatus::time_limit : LaneStatus::none;
        }
        return answer;
    }

  private:
    /// Of the pairs found, of which there must be one.
    const PathPair& best() {
        if (!options_.ranking) return *std::ranges::max_element(pairs_.found(), {}, &PathPair::length_m);
        scores_.resize(pairs_.found().size());
        options_.ranking->score(pairs_.features(), scores_);
        return pairs_.found()[static_cast<std::size_t>(std::ranges::max_element(scores_) - scores_.begin())];
    }

    Lane to_lane(const PathPair& pair, const Scene& scene) const {
        const PathPairVertices vertices = pairs_.vertices(pair);
        Lane lane;
        for (const Vertex vertex : vertices[kLeft]) lane.left.push_back(scene.cones[vertex].id);
        for (const Vertex vertex : vertices[kRight]) lane.right.push_back(scene.cones[vertex].id);
        lane.closed = pair.closed;
        return lane;
    }

    ClcOptions options_;
    EnumerationRules rules_;
    SearchGraph graph_;
    PathPairEnumeration enumeration_;
    PathPairs pairs_;
    std::vector<Point> points_;
    std::vector<double> scores_;
};

}  // namespace

std::unique_ptr<LaneDetector> make_clc_detector(const ClcOptions& options) {
    validate(options);
    return std::make_unique<ClcDetector>(options);
}

}  // namespace conelane
