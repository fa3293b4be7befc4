#pragma once

#include "solvers/path_pair/arc_graph.hpp"
#include "solvers/path_pair/clique_separation.hpp"
#include "solvers/path_pair/edge_sets.hpp"
#include "solvers/path_pair/front_graph.hpp"
#include "solvers/path_pair/front_search.hpp"
#include "solvers/path_pair/incumbent.hpp"
#include "solvers/path_pair/pair_completion.hpp"
#include "solvers/path_pair/pair_relaxation.hpp"
#include "solvers/path_pair/prices.hpp"
#include "solvers/path_pair/search_clock.hpp"
#include "solvers/path_pair/sure_losses.hpp"
#include "solvers/path_pair_solver.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace conelane::path_pair {

/// Depth-first branch and bound over the far ends of the legs and over edges, in or out. Each node raises the
/// bound of the relaxation by ascent, drops arcs and successions whose bound reaches the incumbent, and hands
/// what is left to the search on fronts, which ends nearly every node; else it branches on what the
/// relaxation is least sure about: ends first, for with both of them free two halves of a pair may run along
/// one boundary, and two halves of another along the other.
class BranchAndBound {
  public:
    BranchAndBound(const ArcGraph& graph, Incumbent& incumbent, const PathPairOptions& options);

    struct Outcome {
        double
            bound;  ///< of every lane graph of the system that is cheaper than the cutoff less the tolerance
        bool complete;
    };
    /// All pairs of legs of a system that cost less than the incumbent by more than `tolerance`.
    Outcome run(const LegSystem& system, double tolerance, std::function<bool()> stopped);

    /// The root's ascent alone: its best bound, minus infinity if stopped before there was one.
    double run_root(const LegSystem& system, double tolerance, std::function<bool()> stopped);

    [[nodiscard]] std::int64_t nodes() const { return nodes_; }
    void reset_nodes() { nodes_ = 0; }

    /// Prices of the root's best bound.
    [[nodiscard]] const Prices& root_prices() const { return nodes_by_depth_.front()->prices; }
    [[nodiscard]] const CliquePool& cliques() const { return cliques_; }

  private:
    struct Node {
        ResidualGraph graph;
        Prices prices;  ///< those of the best bound
    };
    enum class Verdict { closed, open, stopped };

    void begin(const LegSystem& system, double tolerance, std::function<bool()> stopped);
    void begin_near();
    Node& node(std::size_t depth);
    void explore(std::size_t depth, double bound, int most_steps);
    Verdict ascend(std::size_t depth, double& bound, int most_steps);
    /// All pairs of a node on the fronts; open where there are more fronts or labels than these.
    /// Precondition: the relaxation was evaluated on the node's graph.
    Verdict search_fronts(const ResidualGraph& graph, std::size_t most_fronts, std::size_t most_labels);
    bool fix(Node& here);
    struct Branching {
        enum class On { nothing, end, edge } on;
        int what;  ///< the cone or the edge
        double use;
    };
    [[nodiscard]] Branching choose(const ResidualGraph& graph) const;
    void branch(const ResidualGraph& source, const Branching& branching, bool in, ResidualGraph& target);
    void decide(const Branching& branching, bool in, bool back);
    void count_usage(const ResidualGraph& graph);
    void separate(const ResidualGraph& graph, Prices& prices);
    [[nodiscard]] double cutoff() const { return incumbent_.cutoff() - tolerance_; }

    const ArcGraph& graph_;
    Incumbent& incumbent_;
    const PathPairOptions& options_;
    double tolerance_ = 0.0;
    std::function<bool()> stopped_;  ///< looks at the clock
    SearchClock clock_;
    CliquePool cliques_;
    CliqueSeparation separation_;
    Decisions decisions_;
    PairRelaxation relaxation_;
    PairCompletion completion_;
    EdgeSets edge_sets_;
    SureLosses sure_losses_;
    FrontGraph fronts_;
    FrontSearch front_search_;
    Ascent ascent_;
    Usage usage_;
    Prices prices_;                 ///< of the current step
    std::vector<double> edge_use_;  ///< averaged over the steps
    std::vector<double> end_use_;   ///< legs that end at a cone, averaged
    std::vector<std::unique_ptr<Node>> nodes_by_depth_;
    ResidualGraph spare_;
    std::vector<int> order_;
    std::vector<int> index_;
    std::vector<char> keep_out_;
    std::vector<char> edge_alive_;
    std::vector<int> walk_edges_;
    double open_bound_ = 0.0;
    std::int64_t nodes_ = 0;
};

}  // namespace conelane::path_pair
