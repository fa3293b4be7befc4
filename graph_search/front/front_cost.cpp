#include "graph_search/front/front_cost.hpp"

namespace conelane {

namespace {

const FrontWeights& valid(const FrontWeights& weights) {
    validate(weights);
    return weights;
}

}  // namespace

FrontCost::Networks::Networks(const FrontWeightSet& weights)
    : extend(weights.extend), stop(weights.stop), start(weights.start) {}

FrontCost::FrontCost(const FrontWeights& weights) : plain_(valid(weights)) {
    if (weights.colored) colored_.emplace(*weights.colored);
}

std::span<const float> FrontCost::score_starts(FrontMap& map, const FrontStarts& starts) {
    for (const Side side : {kLeft, kRight}) {
        start_cones_[side].clear();
        for (const Vertex cone : starts.cones[side]) start_cones_[side].push_back(start_cone(map, cone));
    }
    starts_.clear();
    for (const auto& [left, right] : starts.pairs) {
        for (const Side side : {kLeft, kRight}) {
            const StartCone& own = start_cones_[side][side == kLeft ? left : right];
            const StartCone& other = start_cones_[opposite(side)][side == kLeft ? right : left];
            const StartFeatures seen = start_features(map, own, other, side);
            starts_.insert(starts_.end(), seen.begin(), seen.end());
        }
    }
    const std::size_t count = starts.pairs.size();
    scores_.resize(2 * count);
    FrontSums sums{};
    const FrontNetwork& network = networks_for(map).start;
    network.begin({}, sums);
    network.score(sums, 0, starts_, scores_, map.has_colors() ? 0 : kStartColorFeatures);
    for (std::size_t i = 0; i < count; ++i) scores_[i] = scores_[2 * i] + scores_[2 * i + 1];
    return std::span(scores_).first(count);
}

std::span<const float> FrontCost::score_moves(FrontMap& map, const FrontState& state, Side side,
                                              const FrontMoves& moves) {
    const StateMeasures measures = measure(map, state, side);
    state_ = state_features(map, state, side, measures);
    extensions_.clear();
    for (const FrontMove& move : moves.extensions) {
        const ExtendFeatures seen = extend_features(map, state, side, move, measures);
        extensions_.insert(extensions_.end(), seen.begin(), seen.end());
    }
    const std::size_t count = moves.extensions.size();
    scores_.resize(count + (moves.stops ? 1 : 0));
    FrontSums sums{};
    const bool has_colors = map.has_colors();
    const std::span<const float> state_inputs =
        std::span(state_).first(kStateFeatures - (has_colors ? 0 : kStateColorFeatures));
    const Networks& networks = networks_for(map);
    networks.extend.begin(state_inputs, sums);
    networks.extend.score(sums, kStateFeatures, extensions_, std::span(scores_).first(count),
                          has_colors ? 0 : kExtendColorFeatures);
    if (moves.stops) {
        stop_ = stop_features(map, state, side, extensions_);
        networks.stop.begin(state_inputs, sums);
        networks.stop.score(sums, kStateFeatures, stop_, std::span(scores_).subspan(count));
    }
    return scores_;
}

}  // namespace conelane
