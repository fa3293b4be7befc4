#include "graph_search/lane_consensus.hpp"

#include "graph_search/lane_features.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace conelane {

std::size_t LaneConsensus::choose(const PathPairs& pairs, const SearchGraph& graph,
                                  std::span<const double> scores, std::size_t count) {
    order_.resize(scores.size());
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    count = std::min(count, order_.size());
    std::partial_sort(
        order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(count), order_.end(),
        [&](std::size_t a, std::size_t b) { return scores[a] != scores[b] ? scores[a] > scores[b] : a < b; });
    order_.resize(count);

    members_.clear();
    begins_.assign(1, 0);
    on_.assign(2 * graph.vertex_count(), 0);
    probabilities_.clear();
    for (std::size_t i = 0; i < count; ++i) {
        measure(pairs, graph, i);
        probabilities_.push_back(std::exp(scores[order_[i]] - scores[order_.front()]));
    }

    std::size_t best = 0;
    double best_value = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < count; ++i) {
        std::array<std::uint32_t, kMostCandidates> shared{};
        std::uint32_t keeps_to = ~std::uint32_t{0};  // a bit for each candidate that it does not stray from
        for (std::size_t k = begins_[i]; k < begins_[i + 1]; ++k) {
            const std::uint32_t on = on_[members_[k].vertex];
            if (members_[k].is_near) keeps_to &= on;
            for (std::size_t other = 0; other < kMostCandidates; ++other) shared[other] += (on >> other) & 1U;
        }
        double value = 0.0;
        for (std::size_t other = 0; other < count; ++other) {
            const auto either = static_cast<double>((begins_[i + 1] - begins_[i]) +
                                                    (begins_[other + 1] - begins_[other]) - shared[other]);
            const bool strays = ((keeps_to >> other) & 1U) == 0;
            value += probabilities_[other] *
                     (static_cast<double>(shared[other]) / either - (strays ? kStrayingPenalty : 0.0));
        }
        if (value > best_value) {
            best_value = value;
            best = order_[i];
        }
    }
    return best;
}

void LaneConsensus::measure(const PathPairs& pairs, const SearchGraph& graph, std::size_t place) {
    const PathPair& pair = pairs.found()[order_[place]];
    for (const Side side : {kLeft, kRight}) {
        pairs.vertices(pair, side, side_);
        double along_m = 0.0;
        for (std::size_t i = 0; i < side_.size(); ++i) {
            if (i > 0) along_m += (graph.position(side_[i]) - graph.position(side_[i - 1])).norm();
            const auto member = static_cast<std::uint32_t>(2 * std::size_t{side_[i]} + side);
            members_.push_back({member, along_m <= kNearPart_m});
            on_[member] |= std::uint32_t{1} << place;
        }
    }
    begins_.push_back(members_.size());
}

}  // namespace conelane
