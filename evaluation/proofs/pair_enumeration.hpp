#pragma once

#include "evaluation/proofs/exact_arithmetic.hpp"

#include <set>

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

/// All pairs of legs below a limit, both legs abreast. A frontier is the pair of their last arcs. The arc
/// that is earlier in the graph moves; once its leg has ended, the other one moves. So every pair is one walk
/// from frontier to frontier. Beginnings of pairs are labels at frontiers. A label is dropped if its cost
/// with multipliers plus the cheapest continuation reaches the limit, or if another label there costs no more
/// and excludes nothing that this label leaves to any continuation.
class PairEnumeration {
  public:
    /// Precondition: the bounds were found on the graph, and no walk gains from a cycle.
    PairEnumeration(const ExactScene& scene, const LegKinds& kinds, const WalkGraph& graph,
                    const WalkBounds& bounds, const Exact& limit);

    enum class Outcome { none_below, found_one, too_many_steps };
    /// A step is a frontier that is extended or a label that is looked at; steps are subtracted from
    /// `steps_left`.
    Outcome run(std::int64_t& steps_left);

  private:
    using Set = boost::dynamic_bitset<>;  ///< of edges and, after them, cones
    struct Frontier {
        std::size_t moving;  ///< last arc of the leg that moves, by place in the graph
        std::size_t waiting;
        std::size_t kind;  ///< of the moving leg
        bool ended;        ///< the waiting leg has
        auto operator<=>(const Frontier&) const = default;
    };
    struct Step {
        std::size_t to;
        std::size_t arc;  ///< kNoArc if the leg ends
        Exact cost;       ///< without multipliers
        Exact reduced;
    };
    struct Label {
        Exact cost;
        Exact reduced;
        int along_heading;  ///< edges, at most 2
        Set taken;          ///< edges and cones that are excluded now
    };

    void find_taken();
    [[nodiscard]] std::size_t edge_bit(std::size_t place) const { return graph_.arc[place] / 2; }
    [[nodiscard]] std::size_t tail_bit(std::size_t place) const {
        return scene_.edges.size() + scene_.tail(graph_.arc[place]);
    }
    [[nodiscard]] std::size_t head_bit(std::size_t place) const {
        return scene_.edges.size() + scene_.head(graph_.arc[place]);
    }
    [[nodiscard]] bool fits(const Set& taken, std::size_t place) const {
        return !taken[edge_bit(place)] && !taken[head_bit(place)];
    }

    [[nodiscard]] std::vector<Frontier> first_frontiers() const;
    [[nodiscard]] std::vector<std::size_t> first_places() const;
    [[nodiscard]] Exact start_cost(const Frontier& frontier) const;
    template <typename Visit>
    void for_each_step(const Frontier& frontier, const Visit& visit) const;
    [[nodiscard]] bool is_last(const Frontier& frontier) const;
    [[nodiscard]] bool may_be_below(const Frontier& frontier, const Exact& reduced) const;
    bool find_frontiers(std::int64_t& steps_left);
    void find_steps();
    void find_onward();
    void drop_frontiers();
    void drop_taken_by_all();
    void find_forward();
    void find_wanted();
    Outcome enumerate(std::int64_t& steps_left);
    bool settle(std::size_t frontier, std::int64_t& steps_left);
    void expand(const Label& label, std::size_t frontier);
    [[nodiscard]] Label extended(const Label& label, const Step& step) const;

    const ExactScene& scene_;
    const LegKinds& kinds_;
    const WalkGraph& graph_;
    const WalkBounds& bounds_;
    const Exact limit_;  ///< without multipliers
    const Exact most_;   ///< with them
    std::size_t bits_ = 0;
    std::vector<std::vector<WalkCost>> leg_onward_;  ///< by kind and place
    std::vector<Set> taken_by_;                      ///< by place
    std::vector<Frontier> frontiers_;                ///< ascending
    std::vector<WalkCost> forward_;
    std::vector<WalkCost> onward_;
    std::vector<std::vector<Step>> steps_;
    std::vector<Set> wanted_;  ///< by frontier: edges and cones of walks on
    std::vector<std::vector<Label>> waiting_;
    std::set<std::size_t> open_;
    bool found_one_ = false;
};

}  // namespace conelane
