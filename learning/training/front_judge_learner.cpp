#include "learning/training/front_judge_learner.hpp"

#include "graph_search/front/front_detector.hpp"
#include "learning/training/front_gradient.hpp"

#include <algorithm>
#include <cmath>

namespace conelane::learning {
namespace {

/// -log(probability) of the outcome.
double cross_entropy(double probability, bool happened) {
    constexpr double kMin = 1e-9;
    return -std::log(std::max(kMin, happened ? probability : 1.0 - probability));
}

}  // namespace

FrontJudgeLearner::Loss FrontJudgeLearner::judge(const AnnotatedScene& scene,
                                                 const TrackBoundaries& boundaries,
                                                 const FrontWeights& weights, FrontCost& cost,
                                                 FrontJudge& judge, const FrontLossOptions& options,
                                                 FrontWeights* derivatives) {
    Loss loss;
    loss.risk = options.risk.worst();
    search(scene.scene, cost, options);
    if (contenders_.empty()) return loss;
    truth_.set(scene, front_.map());
    risks_.clear();
    for (const FrontTruth::Cones& lane : lanes_)
        risks_.push_back(truth_.risk(lane, boundaries, options.risk));
    judge.compare(front_, contenders_);
    add_rank(weights, judge, options, loss, derivatives);
    const std::optional<std::size_t> chosen = answered(judge);
    if (!chosen) return loss;
    loss.found = true;
    loss.risk = risks_[*chosen];
    loss.is_usable = truth_.is_usable(lanes_[*chosen], boundaries);
    loss.confidence = judge.confidence(*chosen);
    loss.sum += cross_entropy(loss.confidence, loss.is_usable);
    if (derivatives != nullptr) {
        const double factor = loss.confidence - (loss.is_usable ? 1.0 : 0.0);
        add_derivatives(weights.usable, judge.features(*chosen), static_cast<float>(factor),
                        derivatives->usable);
    }
    add_right(boundaries, weights, judge, *chosen, loss, derivatives);
    loss.trust_where_wrong = trust_where_wrong(boundaries, judge, *chosen);
    return loss;
}

double FrontJudgeLearner::judge_noise(const Scene& scene, const FrontWeights& weights, FrontCost& cost,
                                      FrontJudge& judge, const FrontLossOptions& options,
                                      FrontWeights& derivatives) {
    search(scene, cost, options);
    if (contenders_.empty()) return 0.0;
    judge.compare(front_, contenders_);
    const std::optional<std::size_t> chosen = answered(judge);
    if (!chosen) return 0.0;
    const double confidence = judge.confidence(*chosen);
    add_derivatives(weights.usable, judge.features(*chosen), static_cast<float>(confidence),
                    derivatives.usable);
    const FrontJudge::Step& first = judge.steps()[judge.path(*chosen).front()];
    add_derivatives(weights.right, first.inputs, static_cast<float>(first.right), derivatives.right);
    return cross_entropy(confidence, false) + cross_entropy(first.right, false);
}

/// Sets the contenders and their lanes, the one with the highest score first.
void FrontJudgeLearner::search(const Scene& scene, FrontCost& cost, const FrontLossOptions& options) {
    front_.begin(scene, cost, options.search);
    SearchBudget unlimited;
    front_.run(unlimited);
    front_.sort_finished(FrontJudge::kContenders);
    contenders_.clear();
    lanes_.clear();
    for (const FrontSearch::Finished& lane : front_.finished()) {
        if (contenders_.size() == FrontJudge::kContenders) break;
        FrontTruth::Cones cones;
        front_.cones(lane.parent, cones);
        even_far_ends(front_.map(), cones);
        contenders_.push_back({lane.parent, lane.score});
        lanes_.push_back(std::move(cones));
    }
}

/// The contender that the detector answers; nothing if none is a lane.
std::optional<std::size_t> FrontJudgeLearner::answered(const FrontJudge& judge) const {
    const auto is_lane = [&](std::size_t place) {
        return lanes_[place][kLeft].size() > 1 && lanes_[place][kRight].size() > 1;
    };
    const auto chosen = std::ranges::find_if(judge.order(), is_lane);
    return chosen == judge.order().end() ? std::nullopt : std::optional(*chosen);
}

void FrontJudgeLearner::add_rank(const FrontWeights& weights, const FrontJudge& judge,
                                 const FrontLossOptions& options, Loss& loss,
                                 FrontWeights* derivatives) const {
    std::vector<double> scores;
    for (std::size_t i = 0; i < contenders_.size(); ++i)
        scores.push_back(contenders_[i].score + judge.rank(i));
    const ListLoss list = list_loss(std::move(scores), risks_, options);
    loss.sum += options.minimum_risk * list.expected_risk;
    if (derivatives == nullptr) return;
    for (std::size_t i = 0; i < contenders_.size(); ++i) {
        add_derivatives(weights.rank, judge.features(i), static_cast<float>(list.by_score[i]),
                        derivatives->rank);
    }
}

void FrontJudgeLearner::add_right(const TrackBoundaries& boundaries, const FrontWeights& weights,
                                  const FrontJudge& judge, std::size_t chosen, Loss& loss,
                                  FrontWeights* derivatives) const {
    const FrontTruth::Cones& lane = lanes_[chosen];
    const std::array<std::size_t, 2> right_cones = truth_.right_cones(lane, boundaries);
    std::array<std::size_t, 2> place{};
    for (const std::uint32_t number : judge.path(chosen)) {
        const FrontJudge::Step& step = judge.steps()[number];
        const FrontSearch::Node& node = front_.node(step.node);
        bool is_right = true;
        if (node.parent == FrontSearch::kNone) {
            is_right = right_cones[kLeft] > 0 && right_cones[kRight] > 0;
            place = {1, 1};
        } else {
            const std::size_t cone = place[node.side]++;
            if (cone >= lane[node.side].size()) continue;  // beyond the part of the lane that is answered
            is_right = cone < right_cones[node.side];
        }
        loss.sum += cross_entropy(step.right, is_right);
        if (derivatives != nullptr) {
            add_derivatives(weights.right, step.inputs,
                            static_cast<float>(step.right - (is_right ? 1.0 : 0.0)), derivatives->right);
        }
        if (!is_right) return;
    }
}

double FrontJudgeLearner::trust_where_wrong(const TrackBoundaries& boundaries, FrontJudge& judge,
                                            std::size_t chosen) const {
    const FrontTruth::Cones& lane = lanes_[chosen];
    const std::optional<double> divergence_m = truth_.divergence_m(lane, boundaries);
    if (!divergence_m) return -1.0;
    const auto reaches = judge.reaches(front_, chosen, {lane[kLeft].size(), lane[kRight].size()});
    const auto too_far = [&](const FrontJudge::Reach& reach) { return reach.trusted_m > *divergence_m; };
    const auto wrong = std::ranges::find_if(reaches, too_far);
    return wrong == reaches.end() ? -1.0 : wrong->trust;
}

}  // namespace conelane::learning
