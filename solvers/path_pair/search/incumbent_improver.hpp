#pragma once

#include "solvers/path_pair/bound/pair_relaxation.hpp"
#include "solvers/path_pair/graph/arc_graph.hpp"
#include "solvers/path_pair/graph/residual_graph.hpp"
#include "solvers/path_pair/path_pair_options.hpp"
#include "solvers/path_pair/primal/incumbent.hpp"
#include "solvers/path_pair/primal/incumbent_window.hpp"
#include "solvers/path_pair/primal/pair_beam.hpp"
#include "solvers/path_pair/search/node.hpp"
#include "solvers/path_pair/search/node_ascent.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace conelane::path_pair {

/// Searches for better incumbents in windows, between steps of the root's ascent and between nodes. It
/// improves its own pair of legs in one window after the other, each a node with its own ascent; a pair
/// better than the incumbent becomes the incumbent. Pairs come from the search, from beams, and from the best
/// ones so far.
class IncumbentImprover {
  public:
    IncumbentImprover(const ArcGraph& graph, Incumbent& incumbent, const PathPairOptions& options);

    /// For one search. `starting` by cone: where legs of the system start. The shared relaxation has no
    /// decisions.
    void begin(const LegSystem& system, std::span<const char> starting, CliquePool& cliques,
               SecondLegBound& second_leg, double tolerance, SearchClock& clock);

    /// Continues, for a share of the work that is larger if `bound` is far from the incumbent. `alive`: arcs
    /// that a better lane graph may use.
    void improve(const ResidualGraph& alive, double bound);

    /// The target of the root's ascent.
    [[nodiscard]] const NodeAscent::Aim& aim() const { return aim_; }

  private:
    /// Takes the incumbent for the pair, if the search found a new one.
    void look_at_incumbent();
    [[nodiscard]] bool may_work(double gap, std::int64_t own_work) const;
    void work(const ResidualGraph& alive, double gap);
    void cut_from(const ResidualGraph& alive);
    void begin_phase();
    bool search_window();
    [[nodiscard]] const WindowTuning& tuning() const { return options_.tuning.windows; }

    const ArcGraph& graph_;
    Incumbent& incumbent_;
    const PathPairOptions& options_;
    const LegSystem* system_ = nullptr;
    std::span<const char> starting_;
    CliquePool* cliques_ = nullptr;
    SecondLegBound* second_leg_ = nullptr;
    double tolerance_ = 0.0;
    SearchClock* clock_ = nullptr;

    Incumbent pair_;  ///< the pair that is improved
    bool has_pair_ = false;
    std::optional<std::size_t> new_window_arcs_;  ///< for the pair, if its windows have not begun
    std::size_t phase_ = 0;
    int idle_beams_ = 0;               ///< the last ones, which brought no new pair
    std::vector<double> start_costs_;  ///< of pairs from beams
    std::int64_t own_work_ = 0;        ///< of the clock, up to now
    NodeAscent::Aim aim_;

    ResidualGraph whole_;  ///< what windows are cut from
    bool has_whole_ = false;
    IncumbentWindow window_;
    PairBeam beam_;
    bool has_beam_ = false;  ///< begun for this search
    Decisions no_decisions_;
    NodeAscent ascent_;
    Node node_;
    std::vector<char> usable_;
    std::vector<int> order_;
    std::vector<char> keep_successor_;
    std::vector<int> index_;
};

}  // namespace conelane::path_pair
