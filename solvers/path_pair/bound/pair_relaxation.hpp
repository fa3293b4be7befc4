#pragma once

#include "solvers/path_pair/bound/leg_bounds.hpp"
#include "solvers/path_pair/bound/multipliers.hpp"

#include <array>

namespace conelane::path_pair {

/// Where the two legs begin and end. Only kind 0 is used if both legs are alike.
struct LegSystem {
    struct Kind {
        std::vector<char> start;  ///< by cone
        std::vector<char> end;
    };
    std::array<Kind, 2> kinds;
    int kind_count = 1;
    bool ends_are_partners = true;  ///< the legs' ends must be partners (17); else any ends go together
};

/// Conditions of a branch of the search.
class Decisions {
  public:
    void reset(const ArcGraph& graph);

    /// Precondition: it is not required yet.
    void require_edge(const ArcGraph& graph, int edge);
    [[nodiscard]] bool edge_required(int edge) const { return edge_[to_index(edge)] != 0; }

    /// Whether a far cone ends a leg.
    enum class End : char { open, never, always };
    void decide_end(int cone, End decision);
    [[nodiscard]] End end(int cone) const { return end_[to_index(cone)]; }

    /// Whether a leg may start or end at a cone by this edge. An edge that is required at a cone stays inside
    /// of legs otherwise.
    [[nodiscard]] bool may_be_last(int cone, int by_edge) const {
        const int count = edges_at_[to_index(cone)];
        return count == 0 || (count == 1 && edge_required(by_edge));
    }
    /// Whether two cones may be the ends of the two legs, except for (17).
    [[nodiscard]] bool ends_fit(int cone, int other) const {
        return (end(cone) == End::always ? 1 : 0) + (end(other) == End::always ? 1 : 0) == always_;
    }
    /// By cone, above 0 if every pair of legs of the branch visits it.
    [[nodiscard]] std::span<const int> visited() const { return visited_; }

  private:
    std::vector<char> edge_;
    std::vector<int> edges_at_;
    std::vector<End> end_;
    std::vector<int> visited_;
    int always_ = 0;
};

/// The Lagrangian relaxation of a pair of legs at given multipliers. With F_k(f) the reduced cost of the
/// cheapest walk of kind k that ends at cone f, and h_k(f) the cheapest F of the other leg over the partners
/// of f,
///     bound = min over k, f of F_k(f) + h_k(f) - offset,
/// and, with h as the cost of ending, forward(a) + backward(a) - offset bounds every pair that uses arc a.
class PairRelaxation {
  public:
    PairRelaxation(const ArcGraph& graph, const LegSystem& system, const CliquePool& cliques,
                   const Decisions& decisions, SearchClock& clock)
        : graph_(graph),
          system_(system),
          cliques_(cliques),
          decisions_(decisions),
          clock_(clock),
          bounds_(clock) {}

    /// Forgets the walks of earlier evaluations, so that a search does not depend on the one before.
    void forget() {
        for (Legs& legs : legs_) legs.before.clear();
    }

    /// From now on, each arc costs so much less: in exact arithmetic, too, no cycle then gains at the
    /// multipliers that an evaluation leaves, if this is more than its rounding.
    void set_cycle_margin(double margin) { cycle_margin_ = margin; }

    /// Returns the bound. If a walk gains from a cycle, the multipliers of the cycle's cones are first raised
    /// until the cycle costs nothing. Minus infinity if stopped.
    double evaluate(const ResidualGraph& residual, Multipliers& multipliers);

    /// Backward labels for the multipliers last evaluated. Once the clock has expired, they and the values
    /// below are invalid.
    void evaluate_backward(const ResidualGraph& residual);

    /// By arc: the cheapest continuation from it to an end, for any other leg. Precondition: evaluated.
    void onward(const ResidualGraph& residual, int kind, std::vector<double>& label);

    /// Arcs of the legs that attain the bound.
    [[nodiscard]] const std::array<std::vector<int>, 2>& walks();

    [[nodiscard]] bool symmetric() const { return system_.kind_count == 1; }
    [[nodiscard]] const LegSystem& system() const { return system_; }
    [[nodiscard]] int other(int kind) const { return symmetric() ? 0 : 1 - kind; }
    [[nodiscard]] double offset() const { return offset_; }
    [[nodiscard]] std::span<const double> reduced() const { return reduced_; }
    [[nodiscard]] std::span<const double> start(int kind) const { return legs_[to_index(kind)].start; }
    [[nodiscard]] std::span<const double> forward(int kind) const { return legs_[to_index(kind)].forward; }
    [[nodiscard]] std::span<const double> backward(int kind) const { return legs_[to_index(kind)].backward; }
    /// By arc: h of its head, kUnreachable if a leg must not end with it.
    [[nodiscard]] std::span<const double> end(int kind) const { return legs_[to_index(kind)].end; }
    [[nodiscard]] bool ends_fit(int cone, int other) const {
        return !system_.ends_are_partners ||
               (graph_.are_partners(cone, other) && decisions_.ends_fit(cone, other));
    }
    /// By cone: F, and h.
    [[nodiscard]] std::span<const double> best(int kind) const { return legs_[to_index(kind)].best; }
    [[nodiscard]] std::span<const double> rest(int kind) const { return legs_[to_index(kind)].rest; }
    /// The cones at which the legs of the bound end; -1 without legs.
    [[nodiscard]] const std::array<int, 2>& ends() const { return ends_; }
    [[nodiscard]] bool may_end(const ResidualGraph& residual, int kind, int arc) const;

  private:
    struct Legs {
        std::vector<double> start;
        std::vector<double> forward;
        std::vector<int> before;
        std::vector<double> backward;
        std::vector<double> end;
        std::vector<double> best;   ///< F by cone
        std::vector<int> best_arc;  ///< that attains it
        std::vector<double> rest;   ///< h by cone
    };
    void reduce_arc_costs(const ResidualGraph& residual, const Multipliers& multipliers);
    double combine();
    void pick_ends(const ResidualGraph& residual, int kind);

    const ArcGraph& graph_;
    const LegSystem& system_;
    const CliquePool& cliques_;
    const Decisions& decisions_;
    SearchClock& clock_;
    LegBounds bounds_;
    std::array<Legs, 2> legs_;
    std::vector<double> reduced_;
    std::vector<double> edge_multiplier_;
    std::vector<int> cycles_;
    std::vector<char> reachable_;
    std::vector<double> onward_end_;
    std::array<std::vector<int>, 2> walks_;
    std::array<int, 2> ends_{-1, -1};
    double offset_ = 0.0;
    double cycle_margin_ = 0.0;
};

/// Reduced-cost fixing: arcs and turns whose bound reaches a limit are in no better pair of legs.
class ArcFixing {
  public:
    /// Drops them from the graph. Returns false, without a change, if they are less than a tenth of it: then
    /// renumbering does not pay. `limit`: with offset. Precondition: forward and backward labels are
    /// evaluated on the graph.
    bool drop(const PairRelaxation& relaxation, double limit, ResidualGraph& graph);

  private:
    std::vector<int> order_;
    std::vector<char> keep_successor_;
    std::vector<int> index_;
    ResidualGraph spare_;
};

/// Use of edges and ends by the two walks of the bound: in the last step of an ascent, and averaged over its
/// steps.
class WalkUsage {
  public:
    /// Forgets earlier steps.
    void reset(const ArcGraph& graph);
    /// Adds a step. `memory`: the share of the averages that is kept. Precondition: the relaxation was
    /// evaluated on the residual graph.
    void count(const ArcGraph& graph, const CliquePool& cliques, const ResidualGraph& residual,
               PairRelaxation& relaxation, double memory);

    [[nodiscard]] const Usage& last() const { return last_; }
    /// By edge, averaged: 1 if the two legs together always use it once.
    [[nodiscard]] std::span<const double> edges() const { return edges_; }
    /// By cone, averaged: legs that end there.
    [[nodiscard]] std::span<const double> ends() const { return ends_; }

  private:
    Usage last_;
    std::vector<double> edges_;
    std::vector<double> ends_;
    std::vector<int> times_;  ///< by edge, in the last step
};

}  // namespace conelane::path_pair
