#pragma once

#include "conelane/lane.hpp"
#include "graph_search/front/front_cost.hpp"

#include <bitset>

namespace conelane {

/// Evidence from the last lane of a lap for the next scene. A cone that was on a boundary, found again by its
/// id, earns a bonus wherever a lane has it on that side. New cones and cones that were left aside earn none.
/// So a wrong lane has only the bonuses of its cones over the right one, and only while those cones are seen.
///
/// Other forms were no better: a bonus for a repeated segment, a memory of several scenes, and a charge for
/// cones left aside, which lost overlap.
class FrontEvidence {
  public:
    /// `bonus`: score for each cone, at least 0. Throws InvalidInput if it is not.
    explicit FrontEvidence(double bonus);

    /// Replaces the remembered lane.
    void remember(const Lane& lane);
    void forget() { remembered_.clear(); }

    /// Finds the remembered cones in a scene, from which `map` was built. Keeps memory from call to call.
    void find_again(const Scene& scene, const FrontMap& map);
    /// The bonus of a cone of that scene on a side.
    [[nodiscard]] double bonus(Side side, Vertex cone) const {
        return (sides_[cone] & bit_of(side)) != 0 ? bonus_ : 0.0;
    }

  private:
    [[nodiscard]] static std::uint8_t bit_of(Side side) { return side == kLeft ? 1 : 2; }

    double bonus_;
    std::vector<std::pair<ConeId, std::uint8_t>> remembered_;  ///< by id
    std::vector<std::uint8_t> sides_;                          ///< by cone of the map: a bit for each side
};

struct FrontSearchOptions {
    FrontRules rules;
    std::size_t beam_width = 15;  ///< states kept at each level of progress
    double drop = 4.0;            ///< states farther below the best of their level are dropped
    double finished_drop = 4.0;   ///< and so are states farther below the best lane that has ended
    double level_m = 2.5;         ///< progress, of both boundaries together, from level to level
    double far_m = 100.0;         ///< along the lane, from where a third of the beam goes on: a dense view
                                  ///< holds lanes of 300 m, which nobody drives before the next scene
    bool merge = true;            ///< of the states with the same front only the best is kept
};

/// Throws InvalidInput naming the option that is out of its range.
void validate(const FrontSearchOptions& options);

/// Beam search over fronts. States compete with those of the same progress, the length of both boundaries
/// with what lies before their first cones; of each level the best go on, fewer beyond `far_m`. A level holds
/// the states of one front once, the best of them. Of states of equal score the one found first goes first:
/// cones are in the order of FrontMap, so the answer depends on nothing but the scene and the options.
///
/// A new segment may cross none of the lane's segments and comes nowhere within FrontRules::narrowest_m of
/// the other boundary; no cone is on a lane twice. Where the beam is as wide as there are states, none is
/// dropped or merged, and the rules leave out no segment or start, every lane is met.
class FrontSearch {
  public:
    static constexpr std::size_t kNone = ~std::size_t{0};

    /// A state that may be kept.
    struct Candidate {
        double score;
        std::size_t parent;   ///< kNone: a start
        FrontMove move;       ///< that leads here
        Side side;            ///< that moves
        std::size_t start;    ///< place in FrontStarts::pairs
        float margin = 0.0F;  ///< score of the move over that of the best other one, or start
    };

    struct Node : Candidate {
        FrontState state;
        double bonus;           ///< the part of the score that comes from FrontEvidence
        std::bitset<256> bits;  ///< of the cones of the lane; those with the same remainder share a bit
    };

    /// Keeps the references until the next run, and memory from call to call. With evidence, scores include
    /// its bonuses. Where the budget is spent meanwhile, there is no start.
    void begin(const Scene& scene, FrontCost& cost, const FrontSearchOptions& options,
               FrontEvidence* evidence, SearchBudget& budget);
    void begin(const Scene& scene, FrontCost& cost, const FrontSearchOptions& options,
               FrontEvidence* evidence = nullptr) {
        SearchBudget unlimited;
        begin(scene, cost, options, evidence, unlimited);
    }
    /// Extends the best states of the next level that has any. Returns whether there was such a level; false
    /// if the budget is spent.
    bool advance(SearchBudget& budget);
    /// All levels.
    void run(SearchBudget& budget);

    [[nodiscard]] const FrontSearchOptions& options() const { return options_; }
    [[nodiscard]] FrontMap& map() { return map_; }
    [[nodiscard]] const FrontMap& map() const { return map_; }
    [[nodiscard]] const Node& node(std::size_t number) const { return nodes_[number]; }
    /// How many there are.
    [[nodiscard]] std::size_t nodes() const { return nodes_.size(); }
    /// The states kept on the level before, best first.
    [[nodiscard]] std::span<const std::size_t> level() const { return level_; }
    /// Lanes with both sides stopped, in the order in which they were found.
    struct Finished {
        std::size_t parent;
        Side side;  ///< that stopped last
        double score;
    };
    [[nodiscard]] std::span<const Finished> finished() const { return finished_; }
    /// Sorts the best `count` of them to the front, best first.
    void sort_finished(std::size_t count);
    /// Whether a state, a move or a start was left out that might have led to another lane.
    [[nodiscard]] bool left_out() const { return left_out_; }
    [[nodiscard]] std::int64_t expanded() const { return expanded_; }

    /// The cones of a state, as indices of FrontMap.
    void cones(std::size_t number, std::array<std::vector<Vertex>, 2>& cones) const;
    /// The best lane of the last level that held a lane; kNone if there was none.
    [[nodiscard]] std::size_t open_lane() const { return open_lane_; }

    // For training, which follows the true lane beside the beam.
    [[nodiscard]] const FrontStarts& starts() const { return starts_; }
    /// The level of the last call of advance.
    [[nodiscard]] std::size_t level_number() const { return next_level_ - 1; }
    /// The level that a start belongs to.
    [[nodiscard]] std::size_t first_level(const FrontState& state) const { return level_of(state); }
    /// The level that a state made by a move from `level` belongs to.
    [[nodiscard]] std::size_t level_after(std::size_t level, const FrontState& state) const {
        return std::max(level + 1, level_of(state));
    }
    /// The number of a new state, which is on no level; kNone if a rule of the whole lane forbids it.
    std::size_t add(const Candidate& candidate);

  private:
    /// Place of a candidate on the level whose number of states is being reduced.
    struct Rank {
        double score;
        std::size_t candidate;
    };

    [[nodiscard]] std::size_t level_of(const FrontState& state) const;
    [[nodiscard]] bool is_on_lane(std::size_t number, Vertex cone) const;
    /// Whether the whole lane allows a segment to that cone.
    [[nodiscard]] bool is_free(std::size_t number, Side side, Vertex to) const;
    [[nodiscard]] double bonus(Side side, Vertex cone) const {
        return evidence_ != nullptr ? evidence_->bonus(side, cone) : 0.0;
    }
    [[nodiscard]] bool is_kept_front(const FrontState& state) const;
    void keep_best();
    void expand(std::size_t number);
    void push(std::size_t level, const Candidate& candidate);

    FrontCost* cost_ = nullptr;
    const FrontEvidence* evidence_ = nullptr;
    FrontSearchOptions options_;
    FrontMap map_;
    FrontStarts starts_;
    FrontMoves moves_;
    std::vector<Node> nodes_;
    std::vector<std::vector<Candidate>> levels_;
    std::vector<Rank> ranks_;
    std::vector<std::size_t> level_;
    std::vector<Finished> finished_;
    double best_finished_ = 0.0;  ///< score; minus infinity if no lane has ended
    std::size_t next_level_ = 0;
    std::size_t open_lane_ = kNone;
    std::int64_t expanded_ = 0;
    bool left_out_ = false;
};

}  // namespace conelane
