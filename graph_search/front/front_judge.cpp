#include "graph_search/front/front_judge.hpp"

#include "graph_search/front/front_extend_features.hpp"
#include "graph_search/front/front_features.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <tuple>

namespace conelane {
namespace {

constexpr std::size_t kNone = FrontSearch::kNone;

constexpr double kNear_m = 20.0;
constexpr double kTrustMargin_m = 0.5;
constexpr float kScore = 4.0F;
constexpr float kMax = 2.0F;

float score_input(double score) {
    return std::clamp(static_cast<float>(score) / kScore, -kMax, kMax);
}

/// Inputs of the features of a cone of a lane.
struct ConeSeen {
    bool is_first;     ///< it is of the first pair
    double own_score;  ///< of the move that added it
    double margin;     ///< of that over the best other move
    double share;      ///< probability of the contenders with this segment
    float min_share;
    double lead;  ///< score of the best contender with this segment over the best one without
    double lane_lead;
    double probability;  ///< of the best contender with this segment
};

constexpr std::array<FrontFeatureOf<ConeSeen>, kConeFeatures> kConeSchema{{
    {"is_first", "1", "1 for the first pair", [](auto& s) { return s.is_first ? 1.0F : 0.0F; }},
    {"move_score", "1", "of the move alone", [](auto& s) { return score_input(s.own_score); }},
    {"move_margin", "1", "score over that of the best other move",
     [](auto& s) { return score_input(s.margin); }},
    {"share", "1", "probability of the contenders that have the same segment",
     [](auto& s) { return static_cast<float>(s.share); }},
    {"least_share", "1", "least of this and those before it", [](auto& s) { return s.min_share; }},
    {"lead", "1", "score of the best contender with this segment over the best one without",
     [](auto& s) { return score_input(s.lead); }},
    {"lane_lead", "1", "score of the best contender over the second",
     [](auto& s) { return score_input(s.lane_lead); }},
    {"probability", "1", "of the contender that is the best with this segment",
     [](auto& s) { return static_cast<float>(s.probability); }},
}};

/// Without the bonuses that the search adds for FrontEvidence.
double plain(const FrontSearch::Node& node) {
    return node.score - node.bonus;
}

double probability_of(double log_odds) {
    return 1.0 / (1.0 + std::exp(-log_odds));
}

/// Sum and extreme of the features over the cones of a lane.
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
    float color_against = 0.0F;
    std::array<double, 2> length_m{};
    std::array<float, 2> view_left{1.0F, 1.0F};

    void add(const FrontJudge::Step& step, const FrontSearch::Node& node) {
        constexpr std::size_t kShare = place_of(kConeSchema, "share");
        const auto& cone = step.inputs;
        least_score = std::min(least_score, cone[place_of(kConeSchema, "move_score")]);
        least_margin = std::min(least_margin, cone[place_of(kConeSchema, "move_margin")]);
        least_share = std::min(least_share, cone[kShare]);
        least_lead = std::min(least_lead, cone[place_of(kConeSchema, "lead")]);
        right *= step.right;
        if (std::min(length_m[kLeft], length_m[kRight]) < kNear_m) right_near = right;
        if (node.parent == FrontSearch::kNone) return;
        const float* const move = cone.data() + kConeFeatures + kStateFeatures;
        const auto segment_m = static_cast<double>(node.state.ends[node.side].segment_m);
        length_m[node.side] += segment_m;
        shared_m += static_cast<double>(cone[kShare]) * segment_m;
        longest = std::max(longest, move[place_of(kExtendSchema, "length")]);
        bridges += move[place_of(kExtendSchema, "bridges")];
        inside += move[place_of(kExtendSchema, "inside")];
        inward += move[place_of(kExtendSchema, "beside_inward")];
        outward += move[place_of(kExtendSchema, "beside_outward")];
        narrowest = std::min(narrowest, move[place_of(kExtendSchema, "width")]);
        widest = std::max(widest, move[place_of(kExtendSchema, "width")]);
        deviation += move[place_of(kExtendSchema, "width_deviation")];
        turn_change += move[place_of(kExtendSchema, "turn_change_size")];
        largest_turn = std::max(largest_turn, move[place_of(kExtendSchema, "turn_size")]);
        log_ratio += move[place_of(kExtendSchema, "log_ratio_own_size")];
        color_against += move[place_of(kExtendSchema, "color_against")];
        view_left[node.side] = move[place_of(kExtendSchema, "view_left")];
    }
};

/// Inputs of the features of a whole lane.
struct WholeLaneSeen {
    const Tally& all;
    double behind;  ///< how far its score is below the best one
    double probability;
    double mean_score;  ///< of its moves
    double worst_stop;
    float start_score;
    double both_m;      ///< lengths of both boundaries
    double expected_m;  ///< mean over all contenders, weighted by their probabilities
    float moves;
    double view_m;
    float log_cones_off;
    float color_agreement;
    float color_share;
    float color_consistency;
};

constexpr std::array<FrontFeatureOf<WholeLaneSeen>, kWholeLaneFeatures> kWholeLaneSchema{{
    {"behind", "1", "how far its score is behind the best one",
     [](auto& s) { return score_input(s.behind); }},
    {"probability", "1", "by its score", [](auto& s) { return static_cast<float>(s.probability); }},
    {"precision", "1", "share of its length that others have too, weighed by their probability",
     [](auto& s) { return static_cast<float>(s.all.shared_m / s.both_m); }},
    {"recall", "1", "the same as a share of the length that is expected",
     [](auto& s) { return static_cast<float>(s.all.shared_m / s.expected_m); }},
    {"least_lead", "1", "least lead of its segments over contenders without them",
     [](auto& s) { return s.all.least_lead; }},
    {"least_share", "1", "least share of its segments", [](auto& s) { return s.all.least_share; }},
    {"mean_score", "1", "of its moves", [](auto& s) { return score_input(s.mean_score); }},
    {"least_score", "1", "of its moves: that of the least certain cone",
     [](auto& s) { return s.all.least_score; }},
    {"least_margin", "1", "the same of the margins over other moves",
     [](auto& s) { return s.all.least_margin; }},
    {"right_near", "1", "probability that all cones of the first 20 m are right",
     [](auto& s) { return static_cast<float>(s.all.right_near); }},
    {"right", "1", "probability that all its cones are right",
     [](auto& s) { return static_cast<float>(s.all.right); }},
    {"length", "1", "as a share of the view",
     [](auto& s) { return static_cast<float>(s.both_m / 2.0 / s.view_m); }},
    {"length_expected", "1", "logarithm of its length over the length expected",
     [](auto& s) { return std::clamp(static_cast<float>(std::log(s.both_m / s.expected_m)), -kMax, kMax); }},
    {"sides", "1", "shorter boundary over longer one",
     [](auto& s) {
         return static_cast<float>(std::min(s.all.length_m[kLeft], s.all.length_m[kRight]) /
                                   std::max(s.all.length_m[kLeft], s.all.length_m[kRight]));
     }},
    {"cones", "1", "of both boundaries", [](auto& s) { return std::min(s.moves / 20.0F, kMax); }},
    {"bridges", "1", "segments of more than 5.8 m, up to 4",
     [](auto& s) { return std::min(s.all.bridges, 4.0F) / 2.0F; }},
    {"longest", "m", "segment", [](auto& s) { return s.all.longest; }},
    {"inside", "1", "cones inside, up to 4: a lane is empty",
     [](auto& s) { return std::min(s.all.inside, 4.0F) / 2.0F; }},
    {"beside_inward", "1", "mean nearness of cones inside, beside its segments",
     [](auto& s) { return s.all.inward / s.moves; }},
    {"beside_outward", "1", "the same outside", [](auto& s) { return s.all.outward / s.moves; }},
    {"narrowest", "m", "width at a cone", [](auto& s) { return s.all.narrowest; }},
    {"widest", "m", "width at a cone", [](auto& s) { return s.all.widest; }},
    {"width_deviation", "m", "mean over its cones", [](auto& s) { return s.all.deviation / s.moves; }},
    {"turn_change", "rad", "mean over its cones: bends are arcs",
     [](auto& s) { return s.all.turn_change / s.moves; }},
    {"largest_turn", "rad", "at a cone", [](auto& s) { return s.all.largest_turn; }},
    {"log_ratio", "1", "mean change of the logarithm of its segments' lengths",
     [](auto& s) { return s.all.log_ratio / s.moves; }},
    {"view_left", "m", "of the end that is farther from the edge of view",
     [](auto& s) { return std::max(s.all.view_left[kLeft], s.all.view_left[kRight]); }},
    {"stop_score", "1", "of the worse of both stops", [](auto& s) { return score_input(s.worst_stop); }},
    {"start_score", "1", "of the first pair", [](auto& s) { return s.start_score; }},
    {"cones_off", "1", "logarithm of the cones of the scene over those of the lane",
     [](auto& s) { return s.log_cones_off; }},
    {"color_agreement", "1", "whether the colors of its cones are those of their sides, from -1 to 1",
     [](auto& s) { return s.color_agreement; }},
    {"color_against", "1", "cones of the other side's color, up to 4",
     [](auto& s) { return std::min(s.all.color_against, 4.0F) / 2.0F; }},
    {"color_share", "1", "share of the cones in view that have the color of a side",
     [](auto& s) { return s.color_share; }},
    {"color_consistency", "1", "whether cones next to each other have one color: else many colors are wrong",
     [](auto& s) { return s.color_consistency; }},
}};

/// The lowest score of a stop. The last of the two stops is not a state of its own.
double worst_stop(const FrontSearch& search, const FrontJudge::Contender& lane) {
    double worst = lane.ended ? lane.score - search.node(lane.node).score : 0.0;
    for (std::size_t number = lane.node; search.node(number).parent != FrontSearch::kNone;) {
        const FrontSearch::Node& node = search.node(number);
        if (node.move.stops()) worst = std::min(worst, node.score - search.node(node.parent).score);
        number = node.parent;
    }
    return worst;
}

/// The probability of a step where positions may be more uncertain than the judge has learned from: as that
/// of several cones, the more the larger the variance of its cone. Of the first pair the more uncertain one
/// counts.
double right_of(const FrontMap& map, const FrontSearch::Node& node, double right) {
    constexpr double kPerUnit = 1.0;
    constexpr double kUnit_m2 = 0.04;  // the learned scenes have a noise of 0.2 m at most
    if (!map.has_spread()) return right;
    const auto variance_m2 = [&](Side side) { return map.variance_m2(node.state.ends[side].cones[0]); };
    const double largest_m2 =
        node.parent == kNone ? std::max(variance_m2(kLeft), variance_m2(kRight)) : variance_m2(node.side);
    return std::pow(right, 1.0 + kPerUnit * largest_m2 / kUnit_m2);
}

const FrontWeights& valid(const FrontWeights& weights) {
    validate(weights);
    return weights;
}

}  // namespace

std::span<const FrontFeature, kConeFeatures> cone_feature_table() {
    static constexpr auto kTable = table_of(kConeSchema);
    return kTable;
}
std::span<const FrontFeature, kWholeLaneFeatures> whole_lane_feature_table() {
    static constexpr auto kTable = table_of(kWholeLaneSchema);
    return kTable;
}

std::array<FrontFeatureList, 6> front_feature_lists() {
    return {{{"state", state_feature_table(), kStateColorFeatures},
             {"extend", extend_feature_table(), kExtendColorFeatures},
             {"stop", stop_feature_table(), kStopColorFeatures},
             {"start", start_feature_table(), kStartColorFeatures},
             {"cone", cone_feature_table(), 0},
             {"lane", whole_lane_feature_table(), kWholeLaneColorFeatures}}};
}

FrontJudge::Networks::Networks(const FrontWeightSet& weights)
    : rank(weights.rank), usable(weights.usable), right(weights.right), least_trust(weights.least_trust) {}

FrontJudge::FrontJudge(const FrontWeights& weights) : plain_(valid(weights)) {
    if (weights.colored) colored_.emplace(*weights.colored);
}

void FrontJudge::compare(FrontSearch& search, std::span<const Contender> contenders) {
    sees_colors_ = colored_ && search.map().has_colors();
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
        rank_[i] = static_cast<double>(networks().rank.score(features_[i]));
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
    // Lanes that came to a segment in different ways share it too.
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
        const std::array<float, kConeFeatures> of_cone =
            values_of<kConeSchema>(ConeSeen{.is_first = is_first,
                                            .own_score = own_score,
                                            .margin = static_cast<double>(node.margin),
                                            .share = share,
                                            .min_share = min_share_[i],
                                            .lead = lead,
                                            .lane_lead = lane_lead,
                                            .probability = probability_[best]});
        step.inputs = {};
        std::ranges::copy(of_cone, step.inputs.begin());
        if (!is_first) {
            const FrontState& before = search.node(node.parent).state;
            const StateMeasures measures = measure(search.map(), before, node.side);
            const StateFeatures state = state_features(search.map(), before, node.side, measures);
            const ExtendFeatures move = extend_features(search.map(), before, node.side, node.move, measures);
            auto to = step.inputs.begin() + kConeFeatures;
            to = std::ranges::copy(state, to).out;
            std::ranges::copy(move, to);
        }
        step.right = probability_of(static_cast<double>(networks().right.score(step.inputs)));
    }
}

void FrontJudge::see_lane(FrontSearch& search, const Contender& lane, std::size_t contender) {
    const std::vector<std::uint32_t>& path = paths_[contender];
    Tally all;
    for (const std::uint32_t place : path) all.add(steps_[place], search.node(steps_[place].node));
    const double both_m = all.length_m[kLeft] + all.length_m[kRight];
    const auto moves = static_cast<float>(path.size());
    const double view_m = std::max(search.map().view_radius_m(), 1.0);
    const double cones_off = static_cast<double>(search.map().size()) / static_cast<double>(path.size() + 1);
    features_[contender] = values_of<kWholeLaneSchema>(
        WholeLaneSeen{.all = all,
                      .behind = scores_.front() - scores_[contender],
                      .probability = probability_[contender],
                      .mean_score = scores_[contender] / static_cast<double>(moves),
                      .worst_stop = worst_stop(search, lane),
                      .start_score = steps_[path.front()].inputs[place_of(kConeSchema, "move_score")],
                      .both_m = both_m,
                      .expected_m = expected_m_,
                      .moves = moves,
                      .view_m = view_m,
                      .log_cones_off = static_cast<float>(std::log(cones_off)),
                      .color_agreement = search.node(lane.node).state.color_agreement(),
                      .color_share = search.map().color_share(),
                      .color_consistency = search.map().color_consistency()});
}

double FrontJudge::confidence(std::size_t contender) const {
    return probability_of(static_cast<double>(networks().usable.score(features_[contender])));
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
        trust *= right_of(search.map(), node, steps_[place].right);
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
        if (reach.trust < networks().least_trust) break;
        result_m = reach.trusted_m;
    }
    return result_m;
}

}  // namespace conelane
