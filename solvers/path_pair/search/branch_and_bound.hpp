#pragma once

#include "solvers/path_pair/bound/clique_separation.hpp"
#include "solvers/path_pair/bound/multipliers.hpp"
#include "solvers/path_pair/bound/pair_relaxation.hpp"
#include "solvers/path_pair/frontier/dominated_edges.hpp"
#include "solvers/path_pair/frontier/frontier_graph.hpp"
#include "solvers/path_pair/frontier/frontier_search.hpp"
#include "solvers/path_pair/frontier/onward_tables.hpp"
#include "solvers/path_pair/graph/arc_graph.hpp"
#include "solvers/path_pair/graph/edge_sets.hpp"
#include "solvers/path_pair/path_pair_options.hpp"
#include "solvers/path_pair/primal/frontier_beam.hpp"
#include "solvers/path_pair/primal/incumbent.hpp"
#include "solvers/path_pair/primal/incumbent_window.hpp"
#include "solvers/path_pair/primal/pair_beam.hpp"
#include "solvers/path_pair/primal/pair_completion.hpp"
#include "solvers/path_pair/primal/second_leg_bound.hpp"
#include "solvers/path_pair/search_clock.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace conelane::path_pair {

/// Best-first branch and bound over the far ends of the legs and over edges, in or out. Each node raises the
/// bound of the relaxation by ascent, drops arcs and successions whose bound reaches the incumbent, and
/// searches the fronts of what is left, which ends nearly every node. Else it branches where the relaxation
/// is least sure: on ends first, for with both ends free half of the relaxed optimum may run along one
/// boundary and half along the other.
class BranchAndBound {
  public:
    BranchAndBound(const ArcGraph& graph, Incumbent& incumbent, const PathPairOptions& options);

    struct Outcome {
        /// Of every lane graph of the system that is cheaper than the cutoff less the tolerance.
        double bound;
        bool complete;
    };
    /// All pairs of legs of a system that cost less than the incumbent by more than `tolerance`.
    Outcome run(const LegSystem& system, double tolerance, SearchClock& clock);

    /// The root's ascent alone: its best bound, minus infinity if stopped before there was one.
    double run_root(const LegSystem& system, double tolerance, SearchClock& clock);

    /// The root's ascent without incumbents of its own. Multipliers are whole numbers of `unit`, cycles stay
    /// without gain at them. Returned are those that dropped something, in order, and at last the best ones;
    /// those alone that reach the cutoff where some do. Empty if stopped before there were any.
    std::vector<Multipliers> run_root_in_stages(const LegSystem& system, double unit, SearchClock& clock);

    [[nodiscard]] std::int64_t nodes() const { return nodes_; }
    void reset_nodes() { nodes_ = 0; }

    /// Multipliers of the root's best bound.
    [[nodiscard]] const Multipliers& root_multipliers() const { return root_.multipliers; }
    [[nodiscard]] const CliquePool& cliques() const { return cliques_; }

  private:
    struct Branching {
        enum class On { nothing, end, edge } on;
        int what;  ///< the cone or the edge
        double use;
    };
    struct Decision {
        Branching branching;
        bool in;
    };
    struct Node {
        ResidualGraph graph;
        Multipliers multipliers;  ///< those of the best bound
        std::vector<Decision> decisions;
        double bound = -kUnreachable;
        int max_steps = 0;
        std::size_t number = 0;  ///< nodes that were made before it
    };
    enum class Verdict { closed, open, stopped };

    /// The search for better incumbents in windows, between steps of the ascent and between nodes.
    struct Improvement {
        int phase = 0;
        bool needs_start = true;  ///< no pair is being improved
        bool is_new = false;      ///< the pair comes from elsewhere, its windows are not begun
        bool has_whole = false;
        std::size_t window_arcs = 0;
        Incumbent pair;  ///< that is improved
        Incumbent best;
        double known_cost = kUnreachable;    ///< of the incumbent, when it was last looked at
        double outside_cost = kUnreachable;  ///< of the last incumbent that the ascent found by itself
        std::vector<double> start_costs;
        std::int64_t work = 0;     ///< of the clock, up to now
        std::int64_t entered = 0;  ///< the clock's work then
        // Of the ascent that was interrupted.
        Multipliers multipliers;
        Ascent ascent;
        std::vector<double> edge_use;
        std::vector<double> end_use;
    };

    void begin(const LegSystem& system, double tolerance, SearchClock& clock);
    void begin_improvement();
    /// Searches windows around the incumbent and around pairs of beam searches, for a share of the work that
    /// is larger where `bound` is far from the incumbent. `alive`: what a better lane graph may use.
    void improve_incumbent(const ResidualGraph& alive, double bound);
    [[nodiscard]] bool may_improve(double gap) const;
    void enter_windows(const ResidualGraph& alive);
    void leave_windows();
    void begin_phase();
    bool search_window();
    Verdict explore(Node& node);
    void add_children(const Node& parent);
    Node& add_open_node();
    /// The open node that comes next, off the list: one of the lowest bound, of these the last that was made.
    std::unique_ptr<Node> take_next();
    void take_decisions(const Node& node);
    [[nodiscard]] double min_open_bound() const;

    /// The ascent at a node, step by step.
    struct AscentState {
        int step = 0;
        bool is_root = false;
        int beams = 0;                 ///< run so far
        bool last = false;             ///< the ascent ends with this step
        double value = -kUnreachable;  ///< the bound at this step's multipliers
        double best = -kUnreachable;
        double scale = 1.0;                ///< of the steps
        int since_best = 0;                ///< steps without progress
        int next_completion = 0;           ///< the step that completes walks next
        int first_try = 1;                 ///< the step that tries the fronts first; 0: after a beam
        std::int64_t work = 0;             ///< label updates since the fronts were last tried, about
        double failed_gap = kUnreachable;  ///< the gap at which the fronts were too many
    };
    /// Raises the node's bound. Closed where no better pair is left in it.
    Verdict ascend(Node& here, bool is_root);
    void begin_ascent(const Node& here);
    /// The node's best multipliers so far, with 0 for cliques that came later.
    void take_best_multipliers(const Node& here);
    /// Keeps the multipliers where they are the best so far, and counts steps without progress.
    void note_value(Node& here, AscentState& state);
    /// Offers the incumbent the walks of the bound, completed.
    void complete_walks(const ResidualGraph& graph, AscentState& state);
    /// Searches the fronts at some steps, if they are not too many for the work done so far, and at the last.
    Verdict try_frontiers(const ResidualGraph& graph, AscentState& state);
    void move_multipliers(const Node& here, AscentState& state);
    /// How far the ascent's steps aim above the bound.
    [[nodiscard]] double step_gap(const AscentState& state) const;
    /// The bound at the current multipliers, which are raised to whole units first if there is one.
    double evaluate(const ResidualGraph& graph);
    /// How much a search of fronts may take.
    struct FrontierLimits {
        std::size_t fronts;
        std::size_t labels;
        std::size_t beam_width = 0;  ///< of a beam that looks for an incumbent first; 0: none
    };
    /// Searches all pairs of a node on the fronts; open where there are more fronts or labels than these.
    /// Precondition: the relaxation was evaluated on the node's graph.
    Verdict search_frontiers(const ResidualGraph& graph, const FrontierLimits& limits);
    Verdict search_frontiers_by_target(const ResidualGraph& graph, AscentState& state);
    Verdict search_below(const ResidualGraph& graph, double target, AscentState& state);
    /// Builds the fronts and drops what it can. Closed where nothing is left.
    Verdict build_frontiers(const ResidualGraph& graph, const FrontierLimits& limits);
    void find_tables();
    bool fix(Node& here);
    [[nodiscard]] Branching choose(const ResidualGraph& graph) const;
    void branch(const ResidualGraph& source, const Branching& branching, bool in, ResidualGraph& target);
    void count_usage(const ResidualGraph& graph);
    void separate(const ResidualGraph& graph, Multipliers& multipliers);
    [[nodiscard]] double cutoff() const { return incumbent_.cutoff() - tolerance_; }

    const ArcGraph& graph_;
    Incumbent& incumbent_;
    const PathPairOptions& options_;
    double tolerance_ = 0.0;
    SearchClock* clock_ = nullptr;
    CliquePool cliques_;
    CliqueSeparation separation_;
    Decisions decisions_;
    PairRelaxation relaxation_;
    SecondLegBound second_leg_;
    PairCompletion completion_;
    EdgeSets edge_sets_;
    DominatedEdges dominated_edges_;
    FrontierGraph fronts_;
    OnwardTables onward_tables_;
    FrontierSearch frontier_search_;
    FrontierBeam beam_;
    Ascent ascent_;
    Usage usage_;
    Multipliers multipliers_;       ///< of the current step
    std::vector<double> edge_use_;  ///< averaged over the steps
    std::vector<double> end_use_;   ///< legs that end at a cone, averaged
    Node root_;
    Node window_node_;  ///< a part of the root that is searched for an incumbent
    Improvement improvement_;
    IncumbentWindow window_;
    PairBeam pair_beam_;
    PairRelaxation window_relaxation_;
    bool in_window_ = false;
    const LegSystem* whole_system_ = nullptr;
    ResidualGraph whole_;  ///< the root's as it began
    std::vector<char> starting_;
    std::vector<std::unique_ptr<Node>> open_;
    std::vector<std::unique_ptr<Node>> spare_nodes_;
    std::size_t nodes_made_ = 0;
    ResidualGraph spare_;
    std::vector<int> order_;
    std::vector<int> index_;
    std::vector<char> keep_successor_;
    std::vector<char> edge_alive_;
    double unit_ = 0.0;      ///< of the multipliers; 0 where they are any numbers
    Multipliers evaluated_;  ///< in whole units, those last evaluated
    std::vector<Multipliers> stages_;
    bool frontiers_are_built_ = false;
    std::int64_t nodes_ = 0;
};

}  // namespace conelane::path_pair
