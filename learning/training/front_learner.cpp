#include "learning/training/front_learner.hpp"

#include "graph_search/front/front_detector.hpp"
#include "learning/training/front_gradient.hpp"
#include "learning/training/training_loop.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace conelane::learning {
namespace {

constexpr std::size_t kNone = FrontSearch::kNone;
/// Smaller derivatives are left out.
constexpr double kMinFactor = 1e-4;

}  // namespace

ListLoss list_loss(std::vector<double> scores, std::span<const double> risks,
                   const FrontLossOptions& options) {
    std::vector<double> wanted;
    for (const double risk : risks) wanted.push_back(-risk / options.risk_scale);
    to_probabilities(scores);
    to_probabilities(wanted);
    ListLoss loss;
    for (std::size_t i = 0; i < scores.size(); ++i) loss.expected_risk += scores[i] * risks[i];
    for (std::size_t i = 0; i < scores.size(); ++i) {
        loss.by_score.push_back(options.minimum_risk * scores[i] * (risks[i] - loss.expected_risk) +
                                options.listwise * (scores[i] - wanted[i]));
    }
    return loss;
}

std::size_t FrontLearner::true_start() const {
    const FrontStarts& starts = front_.starts();
    for (std::size_t i = 0; i < starts.pairs.size(); ++i) {
        if (starts.cones[kLeft][starts.pairs[i].left] == truth_.cones()[kLeft].front() &&
            starts.cones[kRight][starts.pairs[i].right] == truth_.cones()[kRight].front()) {
            return i;
        }
    }
    return kNone;
}

FrontMove FrontLearner::true_move(const FrontState& state, Side side) const {
    const std::size_t place = state.ends[side].count;
    return place < truth_.cones()[side].size() ? FrontMove{truth_.cones()[side][place], 0} : FrontMove{};
}

FrontLearner::Loss FrontLearner::imitate(const AnnotatedScene& scene, const FrontWeights& weights,
                                         FrontCost& cost, const FrontSearchOptions& search,
                                         FrontWeights& derivatives) {
    Loss loss;
    front_.begin(scene.scene, cost, search);
    truth_.set(scene, front_.map());
    const std::size_t start = true_start();
    if (start == kNone) return loss;
    const std::span<const float> rows = cost.start_features_seen();
    start_rows_.assign(rows.begin(), rows.end());
    const auto starts = cost.score_starts(front_.map(), front_.starts());
    std::vector<float> probabilities(starts.begin(), starts.end());
    const double true_score = probabilities[start];
    loss.sum += to_probabilities(probabilities) - true_score;
    ++loss.decisions;
    for (std::size_t i = 0; i < probabilities.size(); ++i) {
        const double factor = static_cast<double>(probabilities[i]) - (i == start ? 1.0 : 0.0);
        if (std::abs(factor) > kMinFactor) add_start(i, factor, weights, derivatives);
    }
    std::size_t node = front_.add({0.0, kNone, {}, kLeft, start});
    while (!front_.node(node).state.finished()) {
        const FrontState state = front_.node(node).state;
        const Side side = moving_side(front_.map(), state);
        moves_.list(front_.map(), state, side, search.rules);
        const auto scores = cost.score_moves(front_.map(), state, side, moves_);
        const Vertex to = true_move(state, side).to;
        std::size_t right = moves_.extensions.size();
        if (to != kNoCone) {
            right = static_cast<std::size_t>(std::ranges::find(moves_.extensions, to, &FrontMove::to) -
                                             moves_.extensions.begin());
            if (right == moves_.extensions.size()) return loss;
        }
        probabilities.assign(scores.begin(), scores.end());
        const double score = probabilities[right];
        loss.sum += to_probabilities(probabilities) - score;
        ++loss.decisions;
        // `cost` still has the inputs of its last call, and the derivatives need nothing else.
        std::array<float, kExtendInputs> inputs{};
        std::ranges::copy(cost.state_features_seen(), inputs.begin());
        for (std::size_t i = 0; i < probabilities.size(); ++i) {
            const double factor = static_cast<double>(probabilities[i]) - (i == right ? 1.0 : 0.0);
            if (std::abs(factor) <= kMinFactor) continue;
            if (i < moves_.extensions.size()) {
                std::ranges::copy(cost.extend_features_seen().subspan(i * kExtendFeatures, kExtendFeatures),
                                  inputs.begin() + kStateFeatures);
                add_derivatives(weights.extend, inputs, static_cast<float>(factor), derivatives.extend);
            } else {
                std::ranges::copy(cost.stop_features_seen(), inputs.begin() + kStateFeatures);
                add_derivatives(weights.stop, std::span(inputs).first(kStopInputs),
                                static_cast<float>(factor), derivatives.stop);
            }
        }
        node = front_.add({0.0, node, to == kNoCone ? FrontMove{} : moves_.extensions[right], side, start});
        if (node == kNone) return loss;
    }
    loss.reached = true;
    return loss;
}

void FrontLearner::foresee(Follow& truth, std::size_t level, FrontCost& cost) {
    const FrontSearch::Node& from = front_.node(truth.node);
    const FrontState state = from.state;
    const Side side = moving_side(front_.map(), state);
    moves_.list(front_.map(), state, side, front_.options().rules);
    const FrontMove move = true_move(state, side);
    truth.next = {from.score, truth.node, move, side, from.start};
    const auto scores = cost.score_moves(front_.map(), state, side, moves_);
    if (move.stops()) {
        truth.next.score += static_cast<double>(scores.back());
        truth.ended = state.ends[opposite(side)].stopped;
    } else {
        const auto found = std::ranges::find(moves_.extensions, move.to, &FrontMove::to);
        if (found == moves_.extensions.end()) {
            truth.reachable = false;
            return;
        }
        truth.next.move = *found;
        truth.next.score +=
            static_cast<double>(scores[static_cast<std::size_t>(found - moves_.extensions.begin())]);
    }
    truth.level = front_.level_after(level, moved(front_.map(), state, side, truth.next.move));
}

void FrontLearner::follow(Follow& truth, FrontCost& cost) {
    if (!truth.reachable || truth.lost || truth.ended) return;
    const std::size_t level = front_.level_number();
    if (level < truth.level) return;
    const auto found = std::ranges::find_if(front_.level(), [&](std::size_t number) {
        const FrontSearch::Node& node = front_.node(number);
        return node.parent == truth.next.parent && node.start == truth.next.start &&
               (node.parent == kNone || (node.side == truth.next.side && node.move.to == truth.next.move.to));
    });
    if (found == front_.level().end()) {
        truth.lost = true;
        return;
    }
    truth.node = *found;
    foresee(truth, level, cost);
}

FrontLearner::Loss& FrontLearner::add_fall_out(const Follow& truth, const FrontLossOptions& options,
                                               Loss& loss) {
    std::vector<std::size_t> rivals(front_.level().begin(), front_.level().end());
    const std::size_t right = front_.add(truth.next);
    if (right == kNone) return loss;
    rivals.push_back(right);
    std::vector<double> probabilities;
    for (const std::size_t number : rivals) probabilities.push_back(front_.node(number).score);
    loss.sum += options.fall_out * (to_probabilities(probabilities) - front_.node(right).score);
    ++loss.decisions;
    coefficients_.resize(std::max(coefficients_.size(), right + 1), 0.0);
    for (std::size_t i = 0; i < rivals.size(); ++i) {
        coefficients_[rivals[i]] += options.fall_out * (probabilities[i] - (rivals[i] == right ? 1.0 : 0.0));
    }
    return loss;
}

FrontLearner::Loss FrontLearner::search(const AnnotatedScene& scene, const TrackBoundaries& boundaries,
                                        const FrontWeights& weights, FrontCost& cost,
                                        const FrontLossOptions& options, FrontWeights& derivatives) {
    Loss loss;
    front_.begin(scene.scene, cost, options.search);
    truth_.set(scene, front_.map());
    const std::span<const float> rows = cost.start_features_seen();
    start_rows_.assign(rows.begin(), rows.end());
    coefficients_.clear();
    finishing_.clear();

    Follow truth = begin_truth(cost);
    SearchBudget unlimited;
    while (front_.advance(unlimited)) {
        const bool was_lost = truth.lost;
        follow(truth, cost);
        if (truth.lost && !was_lost) add_fall_out(truth, options, loss);
    }
    loss.reached = truth.reachable;
    loss.kept = truth.reachable && truth.ended && !truth.lost;

    front_.sort_finished(options.listed);
    const std::vector<FrontSearch::Finished> lanes = listed_lanes(truth, options, loss);
    if (lanes.empty()) {
        loss.risk = options.risk.worst();
    } else {
        add_list_loss(lanes, boundaries, options, loss);
    }
    add_coefficients(weights, cost, derivatives);
    return loss;
}

/// The true lane before the first move; not reachable if none of the search's starts is its own.
FrontLearner::Follow FrontLearner::begin_truth(FrontCost& cost) {
    Follow truth;
    const std::size_t start = true_start();
    truth.reachable = start != kNone;
    if (!truth.reachable) return truth;
    truth.next = {static_cast<double>(cost.score_starts(front_.map(), front_.starts())[start]),
                  kNone,
                  {},
                  kLeft,
                  start};
    const auto& [left, right] = front_.starts().pairs[start];
    const FrontState state =
        start_state(front_.map(), front_.starts().cones[kLeft][left], front_.starts().cones[kRight][right]);
    truth.level = front_.first_level(state);
    return truth;
}

/// The best finished lanes, best first, then the true lane if the search kept it but it is not among
/// them.
std::vector<FrontSearch::Finished> FrontLearner::listed_lanes(const Follow& truth,
                                                              const FrontLossOptions& options,
                                                              Loss& loss) const {
    const std::size_t listed = std::min(options.listed, front_.finished().size());
    std::vector<FrontSearch::Finished> lanes(front_.finished().begin(),
                                             front_.finished().begin() + static_cast<std::ptrdiff_t>(listed));
    if (lanes.empty() || !loss.kept) return lanes;
    const auto is_truth = [&](const FrontSearch::Finished& lane) { return lane.parent == truth.node; };
    if (std::ranges::none_of(lanes, is_truth)) {
        const auto own = std::ranges::find_if(front_.finished(), is_truth);
        if (own != front_.finished().end()) lanes.push_back(*own);
    }
    loss.found = lanes.front().parent == truth.node;
    return lanes;
}

void FrontLearner::add_list_loss(std::span<const FrontSearch::Finished> lanes,
                                 const TrackBoundaries& boundaries, const FrontLossOptions& options,
                                 Loss& loss) {
    std::vector<double> risks;
    std::vector<double> scores;
    for (const FrontSearch::Finished& lane : lanes) {
        front_.cones(lane.parent, cones_);
        even_far_ends(front_.map(), cones_);
        risks.push_back(truth_.risk(cones_, boundaries, options.risk));
        scores.push_back(lane.score);
    }
    loss.risk = risks.front();
    const ListLoss list = list_loss(std::move(scores), risks, options);
    loss.sum += options.minimum_risk * list.expected_risk;
    ++loss.decisions;
    for (std::size_t i = 0; i < lanes.size(); ++i) {
        const double factor = list.by_score[i];
        if (std::abs(factor) <= kMinFactor) continue;
        coefficients_.resize(std::max(coefficients_.size(), lanes[i].parent + 1), 0.0);
        coefficients_[lanes[i].parent] += factor;
        finishing_.push_back({lanes[i].parent, lanes[i].side, factor});
    }
}

void FrontLearner::add_coefficients(const FrontWeights& weights, FrontCost& cost, FrontWeights& derivatives) {
    for (const FinishingStop& stop : finishing_) {
        add_move(front_.node(stop.parent).state, stop.side, {}, stop.factor, weights, cost, derivatives);
    }
    // A node has a higher number than its parent.
    for (std::size_t number = coefficients_.size(); number-- > 0;) {
        const double factor = coefficients_[number];
        if (std::abs(factor) <= kMinFactor) continue;
        const FrontSearch::Node& node = front_.node(number);
        if (node.parent == kNone) {
            add_start(node.start, factor, weights, derivatives);
        } else {
            coefficients_[node.parent] += factor;
            add_move(front_.node(node.parent).state, node.side, node.move, factor, weights, cost,
                     derivatives);
        }
    }
}

void FrontLearner::add_move(const FrontState& state, Side side, const FrontMove& move, double factor,
                            const FrontWeights& weights, FrontCost& cost, FrontWeights& derivatives) {
    std::array<float, kExtendInputs> inputs{};
    if (move.stops()) {
        moves_.list(front_.map(), state, side, front_.options().rules);
        static_cast<void>(cost.score_moves(front_.map(), state, side, moves_));
        std::ranges::copy(cost.state_features_seen(), inputs.begin());
        std::ranges::copy(cost.stop_features_seen(), inputs.begin() + kStateFeatures);
        add_derivatives(weights.stop, std::span(inputs).first(kStopInputs), static_cast<float>(factor),
                        derivatives.stop);
        return;
    }
    const StateMeasures measures = measure(front_.map(), state, side);
    std::ranges::copy(state_features(front_.map(), state, side, measures), inputs.begin());
    std::ranges::copy(extend_features(front_.map(), state, side, move, measures),
                      inputs.begin() + kStateFeatures);
    add_derivatives(weights.extend, inputs, static_cast<float>(factor), derivatives.extend);
}

void FrontLearner::add_start(std::size_t start, double factor, const FrontWeights& weights,
                             FrontWeights& derivatives) {
    const std::span<const float> rows(start_rows_);
    for (const std::size_t row : {2 * start, 2 * start + 1}) {
        add_derivatives(weights.start, rows.subspan(row * kStartFeatures, kStartFeatures),
                        static_cast<float>(factor), derivatives.start);
    }
}

}  // namespace conelane::learning
