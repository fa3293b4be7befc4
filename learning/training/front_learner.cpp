#include "learning/training/front_learner.hpp"

#include "evaluation/scoring/divergence.hpp"
#include "evaluation/scoring/score.hpp"
#include "graph_search/front/front_detector.hpp"
#include "learning/training/training_loop.hpp"

namespace conelane::learning {
namespace {

using Units = std::array<float, kFrontUnits>;

CONELANE_SIMD void add_scaled(float factor, const float* from, float* to) {
    for (std::size_t unit = 0; unit < kFrontUnits; ++unit) to[unit] += factor * from[unit];
}

/// Number of cones in one of the lanes but not in the other, as a share of the true ones.
double cone_error(const FrontTruth::Cones& lane, const FrontTruth::Cones& truth) {
    std::size_t shared = 0;
    for (const Side side : {kLeft, kRight}) {
        for (const Vertex cone : lane[side])
            shared += static_cast<std::size_t>(std::ranges::count(truth[side], cone));
    }
    const std::size_t all = lane[kLeft].size() + lane[kRight].size();
    const std::size_t right = truth[kLeft].size() + truth[kRight].size();
    return std::min(1.0, static_cast<double>(all + right - 2 * shared) / static_cast<double>(right));
}

constexpr std::size_t kNone = FrontSearch::kNone;
/// Smaller derivatives are left out.
constexpr double kMinFactor = 1e-4;

/// -log(probability) of the outcome.
double cross_entropy(double probability, bool happened) {
    constexpr double kMin = 1e-9;
    return -std::log(std::max(kMin, happened ? probability : 1.0 - probability));
}

}  // namespace

void add_derivatives(const FrontNetworkWeights& network, std::span<const float> inputs, float factor,
                     FrontNetworkWeights& derivatives) {
    Units sums{};
    std::ranges::copy(network.hidden_bias, sums.begin());
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        if (inputs[i] != 0.0F) add_scaled(inputs[i], network.hidden.data() + i * kFrontUnits, sums.data());
    }
    Units by_sum{};
    for (std::size_t unit = 0; unit < kFrontUnits; ++unit) {
        if (sums[unit] <= 0.0F) continue;
        derivatives.output[unit] += factor * sums[unit];
        by_sum[unit] = factor * network.output[unit];
    }
    add_scaled(1.0F, by_sum.data(), derivatives.hidden_bias.data());
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        if (inputs[i] == 0.0F) continue;
        add_scaled(inputs[i], by_sum.data(), derivatives.hidden.data() + i * kFrontUnits);
        derivatives.linear[i] += factor * inputs[i];
    }
    derivatives.output_bias += factor;
}

void add(FrontWeights& a, const FrontWeights& b) {
    std::vector<std::span<const float>> blocks;
    for_each_block(b, [&](std::span<const float> block) { blocks.push_back(block); });
    auto from = blocks.begin();
    for_each_block(a, [&](std::span<float> block) {
        for (std::size_t i = 0; i < block.size(); ++i) block[i] += (*from)[i];
        ++from;
    });
}

void set_zero(FrontWeights& weights) {
    for_each_block(weights, [](std::span<float> block) { std::ranges::fill(block, 0.0F); });
}

void FrontTruth::set(const AnnotatedScene& scene, const FrontMap& map) {
    scene_ = &scene;
    map_ = &map;
    // From cones of the scene to cones of the map.
    std::vector<Vertex> vertex_of(map.size());
    for (Vertex cone = 0; cone < vertex_of.size(); ++cone) vertex_of[map.scene_index(cone)] = cone;
    const auto index_of = index_by_id(scene.scene);
    for (const Side side : {kLeft, kRight}) {
        cones_[side].clear();
        for (const ConeId id : side == kLeft ? scene.ground_truth->left : scene.ground_truth->right) {
            cones_[side].push_back(vertex_of[index_of.at(id)]);
        }
    }
}

LaneOutline FrontTruth::outline(const Cones& lane) const {
    LaneOutline result;
    for (const Vertex cone : lane[kLeft]) result.left.push_back(map_->position(cone));
    for (const Vertex cone : lane[kRight]) result.right.push_back(map_->position(cone));
    return result;
}

LaneOutline FrontTruth::outline_in_world(const Cones& lane) const {
    LaneOutline result;
    const auto place = [&](const std::vector<Vertex>& from, std::vector<Point>& to) {
        for (const Vertex cone : from) to.push_back(scene_->scene.cones[map_->scene_index(cone)].position);
    };
    place(lane[kLeft], result.left);
    place(lane[kRight], result.right);
    return result;
}

double FrontTruth::risk(const Cones& lane, const TrackBoundaries& boundaries,
                        const FrontRiskOptions& options) const {
    if (lane[kLeft].size() < 2 || lane[kRight].size() < 2) return options.worst();
    if (lane == cones_) return 0.0;
    const double iou = intersection_over_union_of_simple(outline(lane), outline(cones_));
    const double risk = 1.0 - iou + options.cones * cone_error(lane, cones_);
    constexpr double kSurelyUsable = 0.985;
    return iou > kSurelyUsable || is_usable(lane, boundaries) ? risk : risk + options.unusable;
}

bool FrontTruth::is_usable(const Cones& lane, const TrackBoundaries& boundaries) const {
    if (lane[kLeft].size() < 2 || lane[kRight].size() < 2) return false;
    const LaneOutline predicted = outline_in_world(lane);
    const LaneOutline truth = outline_in_world(cones_);
    return conelane::is_usable(lane_length_m(predicted), lane_length_m(truth),
                               conelane::divergence_m(predicted, truth, boundaries));
}

std::array<std::size_t, 2> FrontTruth::right_cones(const Cones& lane,
                                                   const TrackBoundaries& boundaries) const {
    const LaneOutline predicted = outline_in_world(lane);
    const LaneOutline truth = outline_in_world(cones_);
    const auto right = [&](const std::vector<Point>& boundary, const std::vector<Point>& annotated,
                           const Point& first) {
        const auto divergence = boundary_divergence(boundary, annotated, boundaries.closed, first);
        return divergence ? divergence->vertex_off : boundary.size();
    };
    return {right(predicted.left, boundaries.left, truth.left.front()),
            right(predicted.right, boundaries.right, truth.right.front())};
}

std::optional<double> FrontTruth::divergence_m(const Cones& lane, const TrackBoundaries& boundaries) const {
    return conelane::divergence_m(outline_in_world(lane), outline_in_world(cones_), boundaries);
}

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
