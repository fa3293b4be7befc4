#include "graph_search/front/front_detector.hpp"

#include "graph_search/front/front_boundary.hpp"
#include "graph_search/front/front_judge.hpp"
#include "graph_search/weights/shipped_weights.hpp"

namespace conelane {
namespace {

/// Chosen on recorded courses: bonuses from 0.1 to 0.45 improve steadiness, overlap and usable lanes. 0.2 is
/// worse on no set that was measured; a larger bonus is a little steadier, and 0.8 gives fewer usable lanes.
constexpr double kRepeatBonus = 0.2;
/// A lane whose confidence is lower gives way to a boundary seen alone. Of the views that show both
/// boundaries of all recorded courses, it is about one in a thousand; of those with one boundary hidden,
/// nearly half.
constexpr double kMinConfidence = 0.03;
constexpr std::size_t kMinConesInsteadOfLane = 5;  ///< of such a boundary, at least; fewer are found in noise
/// A wide lane may widen by a quarter before its far ends are dropped.
constexpr double kMaxEndWidth = 1.25;

double distance_m(const FrontMap& map, Vertex cone, std::span<const Vertex> boundary) {
    const Point& at = map.position(cone);
    double nearest_m = (at - map.position(boundary.front())).norm();
    for (std::size_t i = 1; i < boundary.size(); ++i) {
        const Segment segment{map.position(boundary[i - 1]), map.position(boundary[i])};
        nearest_m = std::min(nearest_m, foot_point(at, segment).distance_m);
    }
    return nearest_m;
}

/// Mean distance of the nearer half of a boundary from the other boundary.
double near_width_m(const FrontMap& map, const std::vector<Vertex>& boundary,
                    const std::vector<Vertex>& other) {
    const std::size_t near = (boundary.size() + 1) / 2;
    double sum_m = 0.0;
    for (std::size_t i = 0; i < near; ++i) sum_m += distance_m(map, boundary[i], other);
    return sum_m / static_cast<double>(near);
}

class FrontDetector final : public LaneDetector {
  public:
    explicit FrontDetector(const FrontOptions& options)
        : LaneDetector(kFrontDoubledCone_m),
          cost_(options.weights),
          judge_(options.weights),
          options_(options.search) {
        validate(options_);
        if (options.repeat_bonus) evidence_.emplace(*options.repeat_bonus);
    }

    void reset() override {
        if (evidence_) evidence_->forget();
    }

  private:
    LaneAnswer search(const Scene& scene, const DetectionLimits& limits) override {
        SearchBudget budget;
        budget.deadline = Deadline(limits.time_limit_ms);
        LaneAnswer answer;
        if (budget.read_clock()) {
            answer.stopped_by = budget.stopped_by;
            return answer;
        }
        front_.begin(scene, cost_, options_, evidence_ ? &*evidence_ : nullptr, budget);
        front_.run(budget);
        answer.stopped_by = budget.stopped_by;
        answer.enumeration = {front_.expanded(), !answer.stopped_by && !front_.left_out(), {}};
        if (choose(budget.stopped_by.has_value())) {
            answer.status = LaneStatus::found;
            answer.lane = {ids(cones_[kLeft], scene), ids(cones_[kRight], scene)};
            answer.confidence = judge_.confidence(chosen_);
            answer.trusted_m =
                judge_.trusted_m(front_, chosen_, {cones_[kLeft].size(), cones_[kRight].size()});
            if (limits.keep_candidates) add_best_lanes(scene, *answer.enumeration);
            if (!answer.stopped_by && *answer.confidence < kMinConfidence)
                answer_one_boundary(scene, budget, answer, kMinConesInsteadOfLane);
            const bool two_sided = !answer.lane.left.empty() && !answer.lane.right.empty();
            if (evidence_ && two_sided) evidence_->remember(answer.lane);
        } else if (!answer.stopped_by) {
            const bool left_out = front_.left_out() || front_.finished().size() > FrontJudge::kContenders;
            answer.status = left_out ? LaneStatus::stopped : LaneStatus::none;
            if (left_out) answer.stopped_by = StopReason::iterations;
            answer_one_boundary(scene, budget, answer);
        }
        return answer;
    }

    /// Answers with the boundary that is seen alone, if there is one with at least `fewest_cones` cones.
    /// Otherwise only the reason from the budget is added to the answer.
    void answer_one_boundary(const Scene& scene, SearchBudget& budget, LaneAnswer& answer,
                             std::size_t fewest_cones = 0) {
        const std::optional<Side> side = boundary_.find(front_.map(), budget, boundary_cones_);
        if (budget.stopped_by) {
            if (answer.status != LaneStatus::found) answer.status = LaneStatus::stopped;
            answer.stopped_by = budget.stopped_by;
        } else if (side && boundary_cones_.size() >= fewest_cones) {
            answer.status = LaneStatus::found;
            answer.lane = {};
            (side == kLeft ? answer.lane.left : answer.lane.right) = ids(boundary_cones_, scene);
            answer.confidence.reset();
            answer.trusted_m.reset();
        }
    }

    /// Puts the best lane into `cones_` and its index into `chosen_`; returns false if there is none.
    /// `cut_off`: the search was interrupted, and a lane that was still growing may be better than all that
    /// have stopped.
    bool choose(bool cut_off) {
        front_.sort_finished(FrontJudge::kContenders);
        contenders_.clear();
        const std::size_t open = cut_off ? front_.open_lane() : FrontSearch::kNone;
        const auto finished = front_.finished();
        if (open != FrontSearch::kNone &&
            (finished.empty() || front_.node(open).score > finished.front().score)) {
            contenders_.push_back({open, front_.node(open).score, false});
        }
        for (const FrontSearch::Finished& lane : finished) {
            if (contenders_.size() == FrontJudge::kContenders) break;
            contenders_.push_back({lane.parent, lane.score});
        }
        if (contenders_.empty()) return false;
        judge_.compare(front_, contenders_);
        for (const std::size_t place : judge_.order()) {
            if (!take(contenders_[place].node)) continue;
            chosen_ = place;
            return true;
        }
        return false;
    }

    void add_best_lanes(const Scene& scene, Enumeration& best) {
        for (const std::size_t place : judge_.order()) {
            if (!take(contenders_[place].node)) continue;
            Lane lane{ids(cones_[kLeft], scene), ids(cones_[kRight], scene)};
            if (std::ranges::find(best.candidates, lane, &LaneCandidate::lane) != best.candidates.end())
                continue;
            const auto number = static_cast<std::int64_t>(best.candidates.size() + 1);
            best.candidates.push_back({std::move(lane), number, judge_.confidence(place)});
        }
    }

    bool take(std::size_t node) {
        front_.cones(node, cones_);
        even_far_ends(front_.map(), cones_);
        return cones_[kLeft].size() > 1 && cones_[kRight].size() > 1;
    }

    [[nodiscard]] std::vector<ConeId> ids(std::span<const Vertex> cones, const Scene& scene) const {
        std::vector<ConeId> ids;
        ids.reserve(cones.size());
        for (const Vertex cone : cones) ids.push_back(scene.cones[front_.map().scene_index(cone)].id);
        return ids;
    }

    FrontCost cost_;
    FrontJudge judge_;
    FrontSearchOptions options_;
    std::optional<FrontEvidence> evidence_;
    FrontSearch front_;
    std::vector<FrontJudge::Contender> contenders_;
    std::size_t chosen_ = 0;
    BoundarySearch boundary_;
    std::vector<Vertex> boundary_cones_;        ///< of the boundary that is seen alone
    std::array<std::vector<Vertex>, 2> cones_;  ///< of the lane, by side
};

}  // namespace

void even_far_ends(const FrontMap& map, std::array<std::vector<Vertex>, 2>& cones) {
    auto& [left, right] = cones;
    if (left.empty() || right.empty()) return;
    // How many cones of each side are kept.
    const auto evened = [&](double widest_m) {
        std::array<std::size_t, 2> counts{cones[kLeft].size(), cones[kRight].size()};
        while (counts[kLeft] > 0 && counts[kRight] > 0) {
            const auto far = [&](Side side) {
                const std::span<const Vertex> other(cones[opposite(side)].data(), counts[opposite(side)]);
                return distance_m(map, cones[side][counts[side] - 1], other) > widest_m;
            };
            if (far(kLeft)) {
                --counts[kLeft];
            } else if (far(kRight)) {
                --counts[kRight];
            } else {
                break;
            }
        }
        return counts;
    };
    std::array<std::size_t, 2> counts = evened(kMaxLaneWidth_m);
    if (std::min(counts[kLeft], counts[kRight]) < 2) {
        counts =
            evened(kMaxEndWidth * 0.5 * (near_width_m(map, left, right) + near_width_m(map, right, left)));
    }
    left.resize(counts[kLeft]);
    right.resize(counts[kRight]);
}

FrontOptions shipped_front_options() {
    return {shipped_front_weights(), {}};
}

FrontOptions warm_front_options() {
    FrontOptions options = shipped_front_options();
    options.repeat_bonus = kRepeatBonus;
    return options;
}

std::unique_ptr<LaneDetector> make_front_detector(const FrontOptions& options) {
    return std::make_unique<FrontDetector>(options);
}

}  // namespace conelane
