#include "graph_search/front/front_judge.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <tuple>

namespace conelane {
namespace {

constexpr std::size_t kNone = FrontSearch::kNone;

constexpr std::array<FrontFeature, kConeFeatures> kConeTable{{
    {"is_first", "1", "1 for the first pair"},
    {"move_score", "1", "of the move alone"},
    {"move_margin", "1", "score over that of the best other move"},
    {"share", "1", "probability of the contenders that have the same segment"},
    {"least_share", "1", "least of this and those before it"},
    {"lead", "1", "score of the best contender with this segment over the best one without"},
    {"lane_lead", "1", "score of the best contender over the second"},
    {"probability", "1", "of the contender that is the best with this segment"},
}};

constexpr std::array<FrontFeature, kWholeLaneFeatures> kWholeLaneTable{{
    {"behind", "1", "how far its score is behind the best one"},
    {"probability", "1", "by its score"},
    {"precision", "1", "share of its length that others have too, weighed by their probability"},
    {"recall", "1", "the same as a share of the length that is expected"},
    {"least_lead", "1", "least lead of its segments over contenders without them"},
    {"least_share", "1", "least share of its segments"},
    {"mean_score", "1", "of its moves"},
    {"least_score", "1", "of its moves: where it hangs by a thread"},
    {"least_margin", "1", "the same of the margins over other moves"},
    {"right_near", "1", "probability that all cones of the first 20 m are right"},
    {"right", "1", "probability that all its cones are right"},
    {"length", "1", "as a share of the view"},
    {"length_expected", "1", "logarithm of its length over the length expected"},
    {"sides", "1", "shorter boundary over longer one"},
    {"cones", "1", "of both boundaries"},
    {"bridges", "1", "segments of more than 5.8 m, up to 4"},
    {"longest", "m", "segment"},
    {"inside", "1", "cones inside, up to 4: a lane is empty"},
    {"beside_inward", "1", "mean nearness of cones inside, beside its segments"},
    {"beside_outward", "1", "the same outside"},
    {"narrowest", "m", "width at a cone"},
    {"widest", "m", "width at a cone"},
    {"width_deviation", "m", "mean over its cones"},
    {"turn_change", "rad", "mean over its cones: bends are arcs"},
    {"largest_turn", "rad", "at a cone"},
    {"log_ratio", "1", "mean change of the logarithm of its segments' lengths"},
    {"view_left", "m", "of the end that is farther from the edge of view"},
    {"stop_score", "1", "of the worse of both stops"},
    {"start_score", "1", "of the first pair"},
    {"cones_off", "1", "logarithm of the cones of the scene over those of the lane"},
}};

constexpr double kNear_m = 20.0;
constexpr double kTrustMargin_m = 0.5;
constexpr float kScore = 4.0F;
constexpr float kMax = 2.0F;

float score_input(double score) {
    return std::clamp(static_cast<float>(score) / kScore, -kMax, kMax);
}

/// Without what the search adds for FrontEvidence.
double plain(const FrontSearch::Node& node) {
    return node.score - node.bonus;
}

double probability_of(double log_odds) {
    return 1.0 / (1.0 + std::exp(-log_odds));
}

/// What the cones of a lane have in all, and at worst.
struct Tally {
    float least_lead = kMax;
    float least_share = 1.0F;
    float least_score = kMax;
    float least_margin = kMax;
    double right_near = 1.0;
    double right = 1.0;
    double shared_m = 0.0;
    float longest = 0.0F;
    float bridges = 0.0F;
    float inside = 0.0F;
    float inward = 0.0F;
    float outward = 0.0F;
    float narrowest = 4.0F;
    float widest = -4.0F;
    float deviation = 0.0F;
    float turn_change = 0.0F;
    float largest_turn = 0.0F;
    float log_ratio = 0.0F;
    std::array<double, 2> length_m{};
    std::array<float, 2> view_left{1.0F, 1.0F};

    void add(const FrontJudge::Step& step, const FrontSearch::Node& node) {
        const auto& cone = step.inputs;
        least_score = std::min(least_score, cone[1]);
        least_margin = std::min(least_margin, cone[2]);
        least_share = std::min(least_share, cone[3]);
        least_lead = std::min(least_lead, cone[5]);
        right *= step.right;
        if (std::min(length_m[kLeft], length_m[kRight]) < kNear_m) right_near = right;
        if (node.parent == FrontSearch::kNone) return;
        const float* const move = cone.data() + kConeFeatures + kStateFeatures;
        const auto segment_m = static_cast<double>(node.state.ends[node.side].segment_m);
        length_m[node.side] += segment_m;
        shared_m += static_cast<double>(cone[3]) * segment_m;
        longest = std::max(longest, move[ExtendPlace::kLength]);
        bridges += move[ExtendPlace::kBridges];
        inside += move[ExtendPlace::kInside];
        inward += move[ExtendPlace::kBesideInward];
        outward += move[ExtendPlace::kBesideOutward];
        narrowest = std::min(narrowest, move[ExtendPlace::kWidth]);
        widest = std::max(widest, move[ExtendPlace::kWidth]);
        deviation += move[ExtendPlace::kWidthDeviation];
        turn_change += move[ExtendPlace::kTurnChangeSize];
        largest_turn = std::max(largest_turn, move[ExtendPlace::kTurnSize]);
        log_ratio += move[ExtendPlace::kLogRatioOwnSize];
        view_left[node.side] = move[ExtendPlace::kViewLeft];
    }
};

/// The lowest score of a stop. Of both the last one is no state of its own.
double worst_stop(const FrontSearch& search, const FrontJudge::Contender& lane) {
    double worst = lane.ended ? lane.score - search.node(lane.node).score : 0.0;
    for (std::size_t number = lane.node; search.node(number).parent != FrontSearch::kNone;) {
        const FrontSearch::Node& node = search.node(number);
        if (node.move.stops()) worst = std::min(worst, node.score - search.node(node.parent).score);
        number = node.parent;
    }
    return worst;
}

const FrontWeights& valid(const FrontWeights& weights) {
    validate(weights);
    return weights;
}

}  // namespace

std::span<const FrontFeature, kConeFeatures> cone_feature_table() {
    return kConeTable;
}
std::span<const FrontFeature, kWholeLaneFeatures> whole_lane_feature_table() {
    return kWholeLaneTable;
}

FrontJudge::FrontJudge(const FrontWeights& weights)
    : rank_network_(valid(weights).rank),
      usable_network_(weights.usable),
      right_network_(weights.right),
      least_trust_(weights.least_trust) {}

void FrontJudge::look(FrontSearch& search, std::span<const Contender> contenders) {
    scores_.clear();
    for (const Contender& lane : contenders) scores_.push_back(lane.score - search.node(lane.node).bonus);
    double sum = 0.0;
    for (std::size_t i = 0; i < contenders.size(); ++i) {
        probability_[i] = std::exp(scores_[i] - scores_.front());
        sum += probability_[i];
    }
    for (std::size_t i = 0; i < contenders.size(); ++i) probability_[i] /= sum;
    find_steps(search, contenders);
    find_shared(search);
    see_cones(search);
    for (std::size_t i = 0; i < contenders.size(); ++i) {
        see_lane(search, contenders[i], i);
        rank_[i] = static_cast<double>(rank_network_.score(features_[i]));
    }
    order_.resize(contenders.size());
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::ranges::sort(order_, [&](std::size_t a, std::size_t b) {
        return std::tuple(-contenders[a].score - rank_[a], a) <
               std::tuple(-contenders[b].score - rank_[b], b);
    });
}

void FrontJudge::find_steps(const FrontSearch& search, std::span<const Contender> contenders) {
    constexpr std::uint32_t kUnseen = ~std::uint32_t{0};
    steps_.clear();
    on_contenders_.clear();
    step_of_node_.assign(search.nodes(), kUnseen);
    for (std::size_t i = 0; i < contenders.size(); ++i) {
        std::vector<std::uint32_t>& path = paths_[i];
        path.clear();
        for (std::size_t number = contenders[i].node; number != kNone; number = search.node(number).parent) {
            if (search.node(number).parent == kNone || !search.node(number).move.stops())
                path.push_back(static_cast<std::uint32_t>(number));
        }
        std::ranges::reverse(path);
        std::size_t parent = kNone;
        for (std::uint32_t& number : path) {
            std::uint32_t& step = step_of_node_[number];
            if (step == kUnseen) {
                step = static_cast<std::uint32_t>(steps_.size());
                steps_.push_back({number, parent, {}, 0.0});
                on_contenders_.push_back(0);
            }
            on_contenders_[step] |= std::uint32_t{1} << i;
            number = step;
            parent = step;
        }
    }
}

void FrontJudge::find_shared(FrontSearch& search) {
    // Lanes that came to a segment by different ways share it too.
    shared_.clear();
    for (std::uint32_t step = 0; step < steps_.size(); ++step) {
        const FrontSearch::Node& node = search.node(steps_[step].node);
        const bool is_first = node.parent == kNone;
        const auto& cones = node.state.ends[is_first ? kLeft : node.side].cones;
        const std::uint64_t kind = is_first ? 2 : static_cast<std::uint64_t>(node.side);
        const std::uint64_t from = is_first ? node.state.ends[kRight].cones[0] : cones[1];
        constexpr unsigned kBits = 31;
        shared_.push_back({kind << (2 * kBits) | from << kBits | cones[0], step, on_contenders_[step]});
    }
    std::ranges::sort(shared_, [](const Shared& a, const Shared& b) {
        return std::tie(a.segment, a.step) < std::tie(b.segment, b.step);
    });
    expected_m_ = 0.0;
    for (std::size_t first = 0; first < shared_.size();) {
        std::size_t last = first;
        std::uint32_t all = 0;
        for (; last < shared_.size() && shared_[last].segment == shared_[first].segment; ++last)
            all |= shared_[last].contenders;
        double share = 0.0;
        for (std::uint32_t rest = all; rest != 0; rest &= rest - 1)
            share += probability_[static_cast<std::size_t>(std::countr_zero(rest))];
        const FrontSearch::Node& node = search.node(steps_[shared_[first].step].node);
        if (node.parent != kNone)
            expected_m_ += share * static_cast<double>(node.state.ends[node.side].segment_m);
        for (; first < last; ++first) on_contenders_[shared_[first].step] = all;
    }
}

void FrontJudge::see_cones(FrontSearch& search) {
    min_share_.resize(steps_.size());
    const double lane_lead =
        scores_.size() > 1 ? scores_[0] - scores_[1] : static_cast<double>(kMax * kScore);
    for (std::size_t i = 0; i < steps_.size(); ++i) {
        Step& step = steps_[i];
        const FrontSearch::Node& node = search.node(step.node);
        const bool is_first = node.parent == kNone;
        const std::uint32_t with = on_contenders_[i];
        double share = 0.0;
        for (std::uint32_t rest = with; rest != 0; rest &= rest - 1)
            share += probability_[static_cast<std::size_t>(std::countr_zero(rest))];
        const auto best = static_cast<std::size_t>(std::countr_zero(with));
        const auto rival = static_cast<std::size_t>(std::countr_one(with));
        const double lead =
            rival < scores_.size() ? scores_[best] - scores_[rival] : static_cast<double>(kMax * kScore);
        min_share_[i] = std::min(static_cast<float>(share), is_first ? 1.0F : min_share_[step.parent]);
        const double own_score = is_first ? plain(node) : plain(node) - plain(search.node(node.parent));
        step.inputs = {is_first ? 1.0F : 0.0F,
                       score_input(own_score),
                       score_input(static_cast<double>(node.margin)),
                       static_cast<float>(share),
                       min_share_[i],
                       score_input(lead),
                       score_input(lane_lead),
                       static_cast<float>(probability_[best])};
        if (!is_first) {
            const FrontState& before = search.node(node.parent).state;
            const StateMeasures measures = measure(search.map(), before, node.side);
            const StateFeatures state = state_features(search.map(), before, node.side, measures);
            const ExtendFeatures move = extend_features(search.map(), before, node.side, node.move, measures);
            auto to = step.inputs.begin() + kConeFeatures;
            to = std::ranges::copy(state, to).out;
            std::ranges::copy(move, to);
        }
        step.right = probability_of(static_cast<double>(right_network_.score(step.inputs)));
    }
}

void FrontJudge::see_lane(FrontSearch& search, const Contender& lane, std::size_t contender) {
    const std::vector<std::uint32_t>& path = paths_[contender];
    Tally all;
    for (const std::uint32_t place : path) all.add(steps_[place], search.node(steps_[place].node));
    const double both_m = all.length_m[kLeft] + all.length_m[kRight];
    const auto moves = static_cast<float>(path.size());
    const double view_m = std::max(search.map().view_radius_m(), 1.0);
    features_[contender] = {score_input(scores_.front() - scores_[contender]),
                            static_cast<float>(probability_[contender]),
                            static_cast<float>(all.shared_m / both_m),
                            static_cast<float>(all.shared_m / expected_m_),
                            all.least_lead,
                            all.least_share,
                            score_input(scores_[contender] / static_cast<double>(moves)),
                            all.least_score,
                            all.least_margin,
                            static_cast<float>(all.right_near),
                            static_cast<float>(all.right),
                            static_cast<float>(both_m / 2.0 / view_m),
                            std::clamp(static_cast<float>(std::log(both_m / expected_m_)), -kMax, kMax),
                            static_cast<float>(std::min(all.length_m[kLeft], all.length_m[kRight]) /
                                               std::max(all.length_m[kLeft], all.length_m[kRight])),
                            std::min(moves / 20.0F, kMax),
                            std::min(all.bridges, 4.0F) / 2.0F,
                            all.longest,
                            std::min(all.inside, 4.0F) / 2.0F,
                            all.inward / moves,
                            all.outward / moves,
                            all.narrowest,
                            all.widest,
                            all.deviation / moves,
                            all.turn_change / moves,
                            all.largest_turn,
                            all.log_ratio / moves,
                            std::max(all.view_left[kLeft], all.view_left[kRight]),
                            score_input(worst_stop(search, lane)),
                            steps_[path.front()].inputs[1],
                            static_cast<float>(std::log(static_cast<double>(search.map().size()) /
                                                        static_cast<double>(path.size() + 1)))};
}

double FrontJudge::confidence(std::size_t contender) const {
    return probability_of(static_cast<double>(usable_network_.score(features_[contender])));
}

std::span<const FrontJudge::Reach> FrontJudge::reaches(const FrontSearch& search, std::size_t contender,
                                                       const std::array<std::size_t, 2>& cones) {
    reaches_.clear();
    std::array<double, 2> length_m{};
    std::array<std::size_t, 2> counted{1, 1};
    double trust = confidence(contender);
    for (const std::uint32_t place : paths_[contender]) {
        const FrontSearch::Node& node = search.node(steps_[place].node);
        if (node.parent != kNone) {
            if (counted[node.side] == cones[node.side]) continue;
            length_m[node.side] += static_cast<double>(node.state.ends[node.side].segment_m);
            ++counted[node.side];
        }
        trust *= steps_[place].right;
        const double shorter_m = std::min(length_m[kLeft], length_m[kRight]);
        reaches_.push_back({trust, std::max(0.0, shorter_m - kTrustMargin_m)});
    }
    reaches_.back().trusted_m = (length_m[kLeft] + length_m[kRight]) / 2.0;
    return reaches_;
}

double FrontJudge::trusted_m(const FrontSearch& search, std::size_t contender,
                             const std::array<std::size_t, 2>& cones) {
    double result_m = 0.0;
    for (const Reach& reach : reaches(search, contender, cones)) {
        if (reach.trust < least_trust_) break;
        result_m = reach.trusted_m;
    }
    return result_m;
}

}  // namespace conelane
