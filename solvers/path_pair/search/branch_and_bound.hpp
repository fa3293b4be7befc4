#pragma once

#include "solvers/path_pair/search/brancher.hpp"
#include "solvers/path_pair/search/incumbent_improver.hpp"

namespace conelane::path_pair {

/// Best-first branch and bound over the far ends of the legs and over edges, in or out. The ascent at each
/// node closes nearly every node; the others are branched.
class BranchAndBound {
  public:
    /// Graph, system and clock may change from search to search.
    BranchAndBound(const ArcGraph& graph, const LegSystem& system, Incumbent& incumbent,
                   const PathPairOptions& options, SearchClock& clock);

    struct Outcome {
        /// Bound of every lane graph of the system that is cheaper than the cutoff less the tolerance.
        double bound;
        bool complete;
    };
    /// All pairs of legs of the system that cost less than the incumbent by more than its tolerance.
    Outcome run();

    /// Only the root's ascent: its best bound, minus infinity if stopped before there was one.
    double run_root();

    /// The root's ascent without incumbents of its own. Multipliers are multiples of `unit`, and cycles do
    /// not gain with them. Returns the multipliers that dropped something, in order, and finally the best
    /// ones; only those that reach the cutoff if some do. Empty if stopped before there were any.
    std::vector<Multipliers> run_root_in_stages(double unit);

    [[nodiscard]] std::int64_t nodes() const { return nodes_; }
    void reset_nodes() { nodes_ = 0; }

    /// Multipliers of the root's best bound.
    [[nodiscard]] const Multipliers& root_multipliers() const { return root_.multipliers; }
    [[nodiscard]] const CliquePool& cliques() const { return cliques_; }

  private:
    void restart(MultiplierStages* stages = nullptr);
    Verdict explore(Node& node);
    Verdict ascend(Node& node);
    Verdict ascend_root();
    void take_decisions(const Node& node);
    void add_children(const Node& parent, const Branching& branching);

    const ArcGraph& graph_;
    const LegSystem& system_;
    Incumbent& incumbent_;
    const PathPairOptions& options_;
    SearchClock& clock_;
    CliquePool cliques_;
    Decisions decisions_;  ///< of the current node
    SecondLegBound second_leg_;
    NodeAscent ascent_;
    IncumbentImprover improver_;
    Brancher brancher_;
    NodeQueue queue_;
    Node root_;
    std::vector<char> starting_;  ///< by cone: a leg may start there
    std::int64_t nodes_ = 0;
};

}  // namespace conelane::path_pair
