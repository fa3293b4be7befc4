#pragma once

#include "solvers/path_pair/bound/pair_relaxation.hpp"
#include "solvers/path_pair/graph/block_rows.hpp"
#include "solvers/path_pair/graph/edge_sets.hpp"
#include "solvers/path_pair/primal/incumbent.hpp"

namespace conelane::path_pair {

/// Incumbents by a beam search over the frontiers of FrontierGraph, which need not be built for it.
/// Beginnings of both legs wait at the arc that moves next; the arcs are gone through in the residual graph's
/// order, and of each only the beginnings are expanded that promise most: by reduced cost and both legs'
/// cheapest ways on.
class FrontierBeam {
  public:
    FrontierBeam(const ArcGraph& graph, PairRelaxation& relaxation, Incumbent& incumbent,
                 const EdgeSets& edges, SearchClock& clock)
        : graph_(graph), relaxation_(relaxation), incumbent_(incumbent), edges_(edges), clock_(clock) {}

    /// Offers the incumbent every pair of legs that is reached. `width`: beginnings expanded at an arc.
    /// Precondition: the relaxation was evaluated on the residual graph, the edge sets are its sets.
    void run(const ResidualGraph& residual, std::size_t width);

  private:
    struct Label {
        int before;   ///< the label that it continues, -1 for the first of a chain
        int moving;   ///< last arc of the leg that moves, ...
        int waiting;  ///< ... and of the other one
        int next;     ///< of the labels that wait at the arc
        std::uint8_t moving_leg;
        bool ended;                 ///< the waiting leg has
        std::int8_t along_heading;  ///< edges, at most 2
        double cost;                ///< without multipliers
        double reduced;
        double estimate;
    };

    [[nodiscard]] int kind(int leg) const { return relaxation_.symmetric() ? 0 : leg; }
    /// With offset.
    [[nodiscard]] double limit() const { return incumbent_.limit() + relaxation_.offset(); }
    [[nodiscard]] const std::uint64_t* lost(int label) const { return lost_.row(to_index(label)); }
    [[nodiscard]] const Label& label_at(int number) const { return *labels_.row(to_index(number)); }
    void begin(std::size_t width);
    void wait(Label label, const std::uint64_t* lost_before, int arc);
    void settle(int arc, std::size_t width);
    void expand(int label);
    void offer(int label);

    const ArcGraph& graph_;
    PairRelaxation& relaxation_;
    Incumbent& incumbent_;
    const EdgeSets& edges_;
    SearchClock& clock_;
    const ResidualGraph* residual_ = nullptr;
    std::size_t words_ = 0;
    std::array<std::vector<double>, 2> leg_onward_;  ///< by kind and arc
    BlockRows<Label> labels_;
    BlockRows<std::uint64_t> lost_;  ///< by label
    std::vector<int> waiting_;       ///< by arc, the label that came last
    std::vector<int> here_;
    std::vector<std::uint64_t> lost_here_;  ///< of the label that is expanded
    std::array<std::vector<int>, 2> legs_;
    int settled_ = 0;     ///< the arc
    bool again_ = false;  ///< a label waits at an arc before it
};

}  // namespace conelane::path_pair
