#include "graph_search/clc_detector.hpp"

#include "graph_search/rank_net_file.hpp"
#include "graph_search/step_score_file.hpp"
#include "model/invalid_input.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace conelane {
namespace {

/// Raises the share of scenes with a near ground truth among the candidates, most at high rates of false
/// positives.
constexpr double kNextVertexDistanceWeight = 0.8;
/// The same.
constexpr std::uint32_t kSecondSearchDiscrepancies = 3;
/// Fewer lanes leave the track within 20 m, on tracks left out of a training; the lanes are a
/// little shorter.
constexpr std::size_t kAgreeingCandidates = 24;

class ClcDetector final : public LaneDetector {
  public:
    explicit ClcDetector(const ClcOptions& options)
        : ranking_(options.ranking),
          agreeing_candidates_(options.agreeing_candidates),
          warm_start_(options.warm_start),
          search_(options) {
        if (agreeing_candidates_ > LaneAgreement::kMostCandidates) {
            throw InvalidInput("agreeing_candidates",
                               "must be at most " + std::to_string(LaneAgreement::kMostCandidates));
        }
    }

    void reset() override { last_lane_.reset(); }

  private:
    LaneAnswer search(const Scene& scene, const DetectionLimits& limits) override {
        CandidateSearch::Request request;
        request.time_limit_ms = limits.time_limit_ms;
        request.with_features = ranking_ != nullptr;
        if (last_lane_) request.last_lane = &*last_lane_;
        const CandidateSearch::Report report = search_.run(scene, request);
        const std::vector<PathPair>& found = search_.pairs().found();

        LaneAnswer answer;
        answer.enumeration = Enumeration{report.iterations, report.complete, {}};
        if (limits.keep_candidates) {
            for (const PathPair& pair : found) {
                answer.enumeration->candidates.push_back({search_.lane(pair, scene), pair.iteration});
            }
        }
        if (found.empty()) {
            answer.status = report.out_of_time ? LaneStatus::stopped : LaneStatus::none;
            if (report.out_of_time) answer.stopped_by = StopReason::time;
            return answer;
        }
        answer.status = LaneStatus::found;
        answer.lane = search_.lane(best(), scene);
        if (warm_start_) last_lane_ = answer.lane;
        return answer;
    }

    /// Of the pairs found, of which there must be one.
    const PathPair& best() {
        const std::vector<PathPair>& found = search_.pairs().found();
        if (!ranking_) return *std::ranges::max_element(found, {}, &PathPair::length_m);
        scores_.resize(found.size());
        ranking_->score(search_.pairs().features(), scores_);
        if (agreeing_candidates_ > 0) {
            return found[agreement_.choose(search_.pairs(), search_.graph(), scores_, agreeing_candidates_)];
        }
        return found[static_cast<std::size_t>(std::ranges::max_element(scores_) - scores_.begin())];
    }

    std::shared_ptr<const LaneRanking> ranking_;
    std::size_t agreeing_candidates_;
    bool warm_start_;
    CandidateSearch search_;
    LaneAgreement agreement_;
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
    options.next_vertex_distance_weight = kNextVertexDistanceWeight;
    options.step_scores = shipped_step_scores();
    options.second_search_discrepancies = kSecondSearchDiscrepancies;
    return options;
}

ClcOptions extended_clc_options() {
    ClcOptions options;
    static_cast<CandidateSearchOptions&>(options) = extended_search_options();
    options.ranking = extended_rank_net();
    options.agreeing_candidates = kAgreeingCandidates;
    return options;
}

std::unique_ptr<LaneDetector> make_clc_detector(const ClcOptions& options) {
    return std::make_unique<ClcDetector>(options);
}

}  // namespace conelane
