#pragma once

#include "solvers/path_pair/primal/incumbent_window.hpp"
#include "solvers/path_pair/primal/pair_beam.hpp"
#include "solvers/path_pair/search/node_ascent.hpp"

namespace conelane::path_pair {

/// Searches for better incumbents in windows, between steps of the root's ascent and between nodes. It
/// improves its own pair of legs in one window after the other, each a node with its own ascent; a pair
/// better than the incumbent becomes the incumbent. Pairs come from the search, from beams, and from the best
/// ones so far.
class IncumbentImprover {
  public:
    /// The shared cliques and bounds of second legs are those of a search without decisions.
    IncumbentImprover(const ArcGraph& graph, const LegSystem& system, Incumbent& incumbent,
                      const PathPairOptions& options, CliquePool& cliques, SecondLegBound& second_leg,
                      SearchClock& clock);

    /// For another search.
    void restart();

    /// Continues, for a share of the work that is larger if `bound` is far from the incumbent. `alive`: arcs
    /// that a better lane graph may use.
    void improve(const ResidualGraph& alive, double bound);

    /// The target of the root's ascent.
    [[nodiscard]] const NodeAscent::Aim& aim() const { return state_.aim; }

  private:
    /// Takes the incumbent for the pair, if the search found a new one.
    void look_at_incumbent();
    [[nodiscard]] bool may_work(double gap, std::int64_t own_work) const;
    void work(const ResidualGraph& alive, double gap);
    void cut_from(const ResidualGraph& alive);
    void begin_phase();
    bool search_window();
    [[nodiscard]] const WindowTuning& tuning() const { return options_.tuning.windows; }

    /// Of one search.
    struct State {
        bool has_pair = false;                            ///< that is improved
        std::optional<std::size_t> new_window_arcs = {};  ///< for the pair, if its windows have not begun
        std::size_t phase = 0;
        int idle_beams = 0;         ///< the last ones, which brought no new pair
        std::int64_t own_work = 0;  ///< of the clock, up to now
        NodeAscent::Aim aim = {};
        bool has_whole = false;
        bool has_first_steps = false;  ///< of the beam
    };

    const ArcGraph& graph_;
    const LegSystem& system_;
    Incumbent& incumbent_;
    const PathPairOptions& options_;
    CliquePool& cliques_;
    SearchClock& clock_;

    State state_;
    Incumbent pair_;                   ///< the pair that is improved
    std::vector<double> start_costs_;  ///< of pairs from beams
    ResidualGraph whole_;              ///< what windows are cut from
    IncumbentWindow window_;
    PairBeam beam_;
    Decisions no_decisions_;
    NodeAscent ascent_;
    Node node_;
    std::vector<char> usable_;
    std::vector<int> order_;
    std::vector<char> keep_successor_;
    std::vector<int> index_;
};

}  // namespace conelane::path_pair
