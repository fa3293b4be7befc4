#include "graph_search/clc/candidate_search.hpp"

#include "conelane/invalid_input.hpp"

namespace conelane {
namespace {

void require(bool valid, const std::string& key, const std::string& reason) {
    if (!valid) throw InvalidInput(key, reason);
}

}  // namespace

void validate(const CandidateSearchOptions& options) {
    const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
    const auto not_negative = [](double value) { return std::isfinite(value) && value >= 0.0; };
    const auto& [phi_max_rad, w_min_m, w_max_m] = options.bounds;
    const StartVertexRules& start = options.start;
    require(options.iteration_limit > 0, "iteration_limit", "must be positive");
    require(options.memory_limit_bytes > 0, "memory_limit_bytes", "must be positive");
    require(options.starting_pairs > 0, "starting_pairs", "must be positive");
    require(options.beam_width > 0, "beam_width", "must be positive");
    if (options.step_scores) validate(*options.step_scores);
    require(positive(options.d_max_m), "d_max", "must be positive");
    require(phi_max_rad > 0.0 && phi_max_rad <= std::numbers::pi, "phi_max", "must be in (0, pi]");
    require(not_negative(w_min_m), "w_min", "must not be negative");
    require(std::isfinite(w_max_m) && w_max_m > w_min_m, "w_max", "must be above w_min");
    require(positive(start.radius_m), "radius", "must be positive");
    require(positive(start.radius_growth_m), "radius_growth", "must be positive");
    require(std::isfinite(start.largest_radius_m) && start.largest_radius_m >= start.radius_m,
            "largest_radius", "must not be below radius");
    require(not_negative(start.distance_weight), "distance_weight", "must not be negative");
    require(not_negative(options.next_vertex_distance_weight), "next_vertex_distance_weight",
            "must not be negative");
}

CandidateSearch::CandidateSearch(const CandidateSearchOptions& options) : options_(options) {
    validate(options);
    rules_.bounds = options.bounds;
    rules_.d_max_m = options.d_max_m;
    rules_.width_backtracking = options.width_backtracking;
    rules_.next_vertex_distance_weight = options.next_vertex_distance_weight;
}

CandidateSearch::Report CandidateSearch::run(const Scene& scene, const Request& request) {
    Report report;
    rules_.with_features = request.with_features;
    budget_ = SearchBudget{};
    budget_.deadline = request.deadline;
    budget_.memory_limit_bytes = options_.memory_limit_bytes;
    pairs_.clear();
    seed_count_ = 0;
    starts_.find(scene, options_.start, options_.bounds);
    report.exhausted = starts_.complete();
    has_remaining_ = request.last_lane != nullptr && find_remaining(*request.last_lane, scene);
    // Without a start there is no lane, so the graph is not needed.
    if (starts_.ranked().empty() && !has_remaining_) return report;

    points_.clear();
    for (const Cone& cone : scene.cones) points_.push_back(cone.position);
    if (graph_.build(points_, options_.d_max_m, budget_)) {
        reach_.reset(graph_, options_.nearest_neighbours);
        rules_.reach = &reach_;
        next_vertex_.reset(graph_, options_.next_vertex_distance_weight / options_.d_max_m, &reach_);
        rules_.next_vertex = &next_vertex_;
        find_seeds(scene, report);
        for (Seed& seed : seeds()) {
            run_from(seed, &seed == &seeds().back(), scene, report);
            seed.found_end = pairs_.found().size();
        }
        if (reach_.left_out()) report.exhausted = false;
        if (rules_.with_features) add_scene_features(scene);
    } else {
        report.complete = false;
    }
    report.exhausted &= report.complete;
    report.iterations = budget_.iterations;
    if (budget_.stopped_by) report.stopped_by = budget_.stopped_by;
    if (!report.complete && !report.stopped_by) report.stopped_by = StopReason::iterations;
    return report;
}

void CandidateSearch::find_seeds(const Scene& scene, Report& report) {
    if (has_remaining_) add_guided(remaining_);
    if (options_.step_scores && find_beam_guide(scene, report)) add_guided(beam_guide_);
    const std::size_t guided = seed_count_;
    starts_.best(options_.starting_pairs, pairs_to_try_);
    for (const StartPair& start : pairs_to_try_) {
        if (std::ranges::find(seeds().first(guided), start, &Seed::start) == seeds().begin() + guided)
            new_seed(start);
    }
    if (pairs_to_try_.size() < starts_.ranked().size()) report.exhausted = false;
}

bool CandidateSearch::find_remaining(const Lane& lane, const Scene& scene) {
    vertex_of_.clear();
    for (std::size_t i = 0; i < scene.cones.size(); ++i) {
        vertex_of_.emplace_back(scene.cones[i].id, static_cast<Vertex>(i));
    }
    std::ranges::sort(vertex_of_);
    for (const Side side : {kLeft, kRight}) {
        std::vector<Vertex>& rest = remaining_[side];
        rest.clear();
        for (const ConeId id : side == kLeft ? lane.left : lane.right) {
            const auto found = std::ranges::lower_bound(vertex_of_, std::pair(id, Vertex{0}));
            const bool seen = found != vertex_of_.end() && found->first == id;
            if (rest.empty() && (!seen || scene.pose.ahead_m(scene.cones[found->second].position) < 0.0)) {
                continue;
            }
            if (!seen) break;
            rest.push_back(found->second);
        }
        if (rest.empty()) return false;
    }
    return remaining_[kLeft].front() != remaining_[kRight].front();
}

bool CandidateSearch::find_beam_guide(const Scene& scene, Report& report) {
    starts_.best(starts_.ranked().size(), pairs_to_try_);
    beam_.start(graph_, scene, pairs_to_try_, *options_.step_scores, options_.bounds, options_.beam_width,
                &reach_);
    SearchBudget half = budget_;
    half.deadline = Deadline(budget_.deadline.remaining_ms() / 2.0);
    const std::size_t best = beam_.run(half);
    if (half.stopped_by) report.stopped_by = half.stopped_by;
    if (best == LaneBeam::kNone) return false;
    beam_guide_ = beam_.vertices(best, std::move(beam_guide_));
    return true;
}

void CandidateSearch::add_guided(const PathPairVertices& guide) {
    if (std::ranges::find(seeds(), guide, &Seed::guide) != seeds().end()) return;
    new_seed({guide[kLeft].front(), guide[kRight].front()}).guide = guide;
}

CandidateSearch::Seed& CandidateSearch::new_seed(StartPair start) {
    if (seed_count_ == seeds_.size()) seeds_.emplace_back();
    Seed& seed = seeds_[seed_count_++];
    seed.start = start;
    for (std::vector<Vertex>& side : seed.guide) side.clear();
    seed.found_end = 0;
    return seed;
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
        narrow.max_discrepancies = options_.second_search_discrepancies;
        (void)enumeration_.run(graph_, seed.start, scene.pose.heading(), narrow, budget_, pairs_, seed.guide);
    }
    report.complete &= complete;
}

void CandidateSearch::add_scene_features(const Scene& scene) {
    const std::span<LaneFeatures> features = pairs_.features();
    double max_length_m = 0.0;
    for (const LaneFeatures& lane : features) max_length_m = std::max(max_length_m, lane[kLength]);
    std::size_t i = 0;
    for (const Seed& seed : seeds()) {  // later entries are left over from earlier scenes
        const StartPairMeasures measures = start_pair_measures(scene, seed.start);
        for (; i < seed.found_end; ++i) {
            LaneFeatures& lane = features[i];
            lane[kMaxShare] = lane[kLength] / max_length_m;
            lane[kStartAsymmetry] = measures.asymmetry_m;
            lane[kStartDistance] = measures.distance_m;
            lane[kSceneCones] = static_cast<double>(scene.cones.size());
            lane[kStartLead] = measures.lead_m;
            lane[kStartShift] = measures.shift_m;
            lane[kStartNearestSide] = measures.nearest_side_m;
            lane[kStartNearestAhead] = measures.nearest_ahead_m;
            lane[kStartFarthestAhead] = measures.farthest_ahead_m;
        }
    }
}

Lane CandidateSearch::lane(const PathPair& pair, const Scene& scene) {
    Lane lane;
    vertices_ = pairs_.vertices(pair, std::move(vertices_));
    for (const Side side : {kLeft, kRight}) {
        std::vector<ConeId>& ids = side == kLeft ? lane.left : lane.right;
        ids.reserve(vertices_[side].size());
        for (const Vertex vertex : vertices_[side]) ids.push_back(scene.cones[vertex].id);
    }
    lane.closed = pair.closed;
    return lane;
}

}  // namespace conelane
