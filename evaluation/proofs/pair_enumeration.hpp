#pragma once

#include "evaluation/proofs/exact_costs.hpp"
#include "evaluation/proofs/walk_bounds.hpp"

#include <cstddef>
#include <cstdint>
#include <set>
#include <vector>

namespace conelane {

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
