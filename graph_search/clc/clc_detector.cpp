#include "graph_search/clc/clc_detector.hpp"

#include "graph_search/weights/shipped_weights.hpp"

namespace conelane {
namespace {

/// By the rules, cones stand at most 5 m apart, so this is the gap that one missed cone leaves. With the 5.5
/// m of the paper, a lane ends at such a gap: with 5 % of the cones missed, a third of the lanes is too short
/// to drive.
constexpr double kMaxGap_m = 10.0;
/// Raises the share of scenes with a near ground truth among the candidates, most of all at high rates of
/// false positives.
constexpr double kNextVertexDistanceWeight = 1.45;
/// Has the same purpose.
constexpr std::uint32_t kSecondSearchDiscrepancies = 3;
/// Steps to the other neighbours take time in narrow hairpins and are rarely right. 16 is faster, but
/// has fewer usable lanes in some conditions.
constexpr std::size_t kNearestNeighbours = 20;

/// Candidates between two checks of the clock: under 1 ms of work, and more than 2500 iterations find.
constexpr std::size_t kRankedAtOnce = 4096;

class ClcDetector final : public LaneDetector {
  public:
    explicit ClcDetector(const ClcOptions& options)
        : ranking_(options.ranking), warm_start_(options.warm_start), search_(options) {}

    void reset() override { last_lane_.reset(); }

  private:
    LaneAnswer search(const Scene& scene, const DetectionLimits& limits) override {
        const Deadline deadline(limits.time_limit_ms);
        CandidateSearch::Request request;
        request.deadline = deadline;
        request.with_features = ranking_ != nullptr;
        if (last_lane_) request.last_lane = &*last_lane_;
        const CandidateSearch::Report report = search_.run(scene, request);
        const std::vector<PathPair>& found = search_.pairs().found();

        LaneAnswer answer;
        answer.enumeration = Enumeration{report.iterations, report.complete, {}};
        answer.stopped_by = report.stopped_by;
        if (limits.keep_candidates) {
            for (const PathPair& pair : found) {
                answer.enumeration->candidates.push_back({search_.lane(pair, scene), pair.iteration});
            }
        }
        if (found.empty()) {
            answer.status = report.exhausted ? LaneStatus::none : LaneStatus::stopped;
            if (!report.exhausted && !report.stopped_by) answer.stopped_by = StopReason::iterations;
            // The beam search may have used its half of the time; the enumeration after it was complete.
            if (report.exhausted) answer.stopped_by.reset();
            return answer;
        }
        const std::size_t chosen = choose(deadline, answer.stopped_by);
        answer.status = LaneStatus::found;
        answer.lane = search_.lane(found[chosen], scene);
        if (warm_start_) last_lane_ = answer.lane;
        return answer;
    }

    /// Returns the index of the answer among the pairs found. Precondition: there is a pair. If the time ends
    /// before all are ranked, the others are left out and `stopped_by` says so.
    std::size_t choose(const Deadline& deadline, std::optional<StopReason>& stopped_by) {
        const std::vector<PathPair>& found = search_.pairs().found();
        if (!ranking_) {
            return static_cast<std::size_t>(std::ranges::max_element(found, {}, &PathPair::length_m) -
                                            found.begin());
        }
        scores_.resize(found.size());
        const std::span<const LaneFeatures> features = std::as_const(search_).pairs().features();
        std::size_t ranked = 0;
        while (ranked < found.size()) {
            const std::size_t count = std::min(kRankedAtOnce, found.size() - ranked);
            ranking_->score(features.subspan(ranked, count), std::span(scores_).subspan(ranked, count));
            ranked += count;
            if (ranked < found.size() && deadline.passed()) {
                stopped_by = StopReason::time;
                break;
            }
        }
        const std::span<const double> scores(scores_.data(), ranked);
        return static_cast<std::size_t>(std::ranges::max_element(scores) - scores.begin());
    }

    std::shared_ptr<const LaneRanking> ranking_;
    bool warm_start_;
    CandidateSearch search_;
    std::vector<double> scores_;
    std::optional<Lane> last_lane_;
};

}  // namespace

ClcOptions paper_clc_options() {
    ClcOptions options;
    options.ranking = paper_rank_net();
    return options;
}

CandidateSearchOptions extended_search_options() {
    CandidateSearchOptions options;
    options.d_max_m = kMaxGap_m;
    options.next_vertex_distance_weight = kNextVertexDistanceWeight;
    options.step_scores = shipped_step_scores();
    options.nearest_neighbours = kNearestNeighbours;
    options.second_search_discrepancies = kSecondSearchDiscrepancies;
    return options;
}

ClcOptions extended_clc_options() {
    ClcOptions options;
    static_cast<CandidateSearchOptions&>(options) = extended_search_options();
    options.ranking = extended_rank_net();
    return options;
}

std::unique_ptr<LaneDetector> make_clc_detector(const ClcOptions& options) {
    return std::make_unique<ClcDetector>(options);
}

}  // namespace conelane
