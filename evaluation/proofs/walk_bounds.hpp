#pragma once

#include "evaluation/proofs/exact_costs.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace conelane {

/// Where the two legs of a pair begin and end. One kind if both legs are alike, else two.
struct LegKinds {
    std::vector<std::vector<bool>> start;  ///< by kind and cone
    std::vector<std::vector<bool>> end;
    const std::vector<std::vector<bool>>* partners =
        nullptr;  ///< of ends; if absent, any two ends may be combined

    [[nodiscard]] std::size_t count() const { return start.size(); }
    [[nodiscard]] std::size_t other(std::size_t kind) const { return count() == 1 ? 0 : 1 - kind; }
};

/// Costs with multipliers: see BoundCertificate.
struct WalkPrices {
    std::vector<Exact> edge;  ///< cost of the edge, with multipliers of cliques and heading
    std::vector<Exact> cone;
    Exact offset = 0;  ///< constant part of the relaxed constraints
};

/// Arcs and turns that walks may use, in the order in which walks from a start reach them.
struct WalkGraph {
    struct Turn {
        std::size_t to;  ///< position of the next arc
        Exact cost;
    };
    std::vector<std::size_t> arc;  ///< arc of the exact scene, by position
    std::vector<std::vector<Turn>> turns;
};

/// All arcs that a start reaches, breadth first.
[[nodiscard]] WalkGraph all_walks(const ExactScene& scene, const LegKinds& kinds);

/// The cost of a walk; nothing if there is none.
using WalkCost = std::optional<Exact>;
[[nodiscard]] inline WalkCost sum(const WalkCost& a, const Exact& b) {
    return a ? WalkCost(*a + b) : std::nullopt;
}
[[nodiscard]] inline WalkCost sum(const WalkCost& a, const WalkCost& b) {
    return b ? sum(a, *b) : std::nullopt;
}
/// Whether the first walk is cheaper.
[[nodiscard]] inline bool cheaper(const WalkCost& a, const WalkCost& b) {
    return a && (!b || *a < *b);
}

/// Cheapest walks, by Bellman-Ford rounds.
class WalkBounds {
  public:
    WalkBounds(const ExactScene& scene, const LegKinds& kinds, WalkPrices prices);

    /// Returns false if a walk gains from a cycle. The graph must outlive the use of the results.
    bool find(const WalkGraph& graph);

    /// No pair of walks costs less; the largest Exact if there is none.
    [[nodiscard]] Exact bound() const;
    /// Arcs and turns that may be part of a pair of walks that costs less than the limit.
    [[nodiscard]] WalkGraph below(const WalkGraph& graph, const Exact& limit) const;

    [[nodiscard]] const Exact& offset() const { return prices_.offset; }
    /// By place: the cost with the multiplier of the arc's head.
    [[nodiscard]] const Exact& reduced(std::size_t place) const { return reduced_[place]; }
    /// The cost of beginning a walk with the arc, the arc included.
    [[nodiscard]] WalkCost start(std::size_t kind, std::size_t place) const;
    /// The cost of ending a leg with the arc.
    [[nodiscard]] WalkCost end(std::size_t kind, std::size_t place) const;
    /// Cheapest continuation from the arc to an end, for any other leg.
    [[nodiscard]] std::vector<WalkCost> onward(std::size_t kind) const;
    [[nodiscard]] const WalkCost& forward(std::size_t kind, std::size_t place) const {
        return forward_[kind][place];
    }

  private:
    bool find_forward(std::size_t kind);
    void find_rest();
    [[nodiscard]] std::vector<WalkCost> backward(std::size_t kind, std::span<const WalkCost> last) const;

    const ExactScene& scene_;
    const LegKinds& kinds_;
    WalkPrices prices_;
    const WalkGraph* graph_ = nullptr;
    std::vector<Exact> reduced_;
    std::vector<std::vector<WalkCost>> forward_;  ///< by kind and place
    std::vector<std::vector<WalkCost>> best_;     ///< by kind and cone where a leg ends
    std::vector<std::vector<WalkCost>> rest_;     ///< the best other leg for it
};

}  // namespace conelane
