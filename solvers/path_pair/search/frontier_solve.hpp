#pragma once

#include "solvers/path_pair/frontier/frontier_search.hpp"
#include "solvers/path_pair/path_pair_options.hpp"
#include "solvers/path_pair/primal/frontier_beam.hpp"
#include "solvers/path_pair/search/node.hpp"

namespace conelane::path_pair {

/// All pairs of a node by a search on the frontiers: edge sets, dominated edges, frontiers, onward tables,
/// labels. Precondition of all searches: the relaxation was evaluated on the node's graph.
class FrontierSolve {
  public:
    static constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();
    /// How much a search may take.
    struct Limits {
        std::size_t frontiers = kAny;
        std::size_t labels = kAny;
        std::size_t beam_width = 0;  ///< of a beam that looks for an incumbent first; 0: none
    };
    /// Of a search by targets.
    struct TargetLimits {
        std::size_t frontiers;  ///< below a target
        bool lowers_targets;    ///< where a target has too many
    };

    FrontierSolve(const ArcGraph& graph, PairRelaxation& relaxation, Incumbent& incumbent,
                  const PathPairOptions& options, SearchClock& clock)
        : graph_(graph),
          relaxation_(relaxation),
          incumbent_(incumbent),
          options_(options),
          clock_(clock),
          frontiers_(relaxation, clock),
          onward_tables_(frontiers_, edge_sets_, clock),
          search_(graph, relaxation, incumbent, frontiers_, edge_sets_, onward_tables_, clock),
          beam_(graph, relaxation, incumbent, edge_sets_, clock) {}

    /// Open where there are more frontiers or labels than the limits.
    Verdict search(const ResidualGraph& graph, const Limits& limits);

    /// Searches for pairs below targets between the bound and the incumbent first. Frontiers and labels are
    /// far fewer below a lower target; a pair that is found there is the best one, and where there is none
    /// the target is a bound, to which `bound` rises. Where they are too many, a still lower target raises
    /// the bound that the node leaves open.
    Verdict search_by_target(const ResidualGraph& graph, const TargetLimits& limits, double& bound);

    /// An incumbent by a beam. Precondition: the last search was that of this graph.
    void run_beam(const ResidualGraph& graph, std::size_t width) { beam_.run(graph, width); }

  private:
    std::optional<Verdict> build(const ResidualGraph& graph, const Limits& limits);
    Verdict search_built(std::size_t max_labels);
    Verdict search_below(const ResidualGraph& graph, double target, std::size_t max_frontiers, double& bound);
    void find_tables() { onward_tables_.find(limit(), is_wide()); }
    [[nodiscard]] bool is_wide() const { return frontiers_.size() >= tuning().wide_frontiers; }
    /// With offset.
    [[nodiscard]] double limit() const { return incumbent_.limit() + relaxation_.offset(); }
    [[nodiscard]] const FrontierTuning& tuning() const { return options_.tuning.frontiers; }

    const ArcGraph& graph_;
    PairRelaxation& relaxation_;
    Incumbent& incumbent_;
    const PathPairOptions& options_;
    SearchClock& clock_;
    EdgeSets edge_sets_;
    DominatedEdges dominated_edges_;
    FrontierGraph frontiers_;
    OnwardTables onward_tables_;
    FrontierSearch search_;
    FrontierBeam beam_;
};

}  // namespace conelane::path_pair
