#pragma once

#include "solvers/path_pair/bound/leg_search.hpp"
#include "solvers/path_pair/bound/pair_relaxation.hpp"

namespace conelane::path_pair {

/// The bound of a second leg for a given first one: a shortest walk over the arcs that the first leg leaves,
/// at true costs. Cones of the first leg and edges incompatible with it are left out, so nothing else couples
/// the legs; multipliers on cones keep walks from cycles. They are kept from one first leg to the next.
class SecondLegBound {
  public:
    SecondLegBound(const ArcGraph& graph, SearchClock& clock)
        : graph_(graph), clock_(clock), bounds_(clock) {}

    /// Sets the multipliers to 0. Call it for each graph, and for each search that is to begin anew.
    void reset();

    /// The second legs of `kind` that go with `first`, arcs of the residual graph. Precondition: the
    /// relaxation was evaluated on it.
    void assign(const PairRelaxation& relaxation, const ResidualGraph& residual, int kind,
                std::span<const int> first);

    /// The cheapest walk, without gaining cycles. `budget` is reduced by each arc of each pass. Returns false
    /// if the clock expired.
    bool evaluate(std::int64_t& budget);
    /// The walk's bound of every second leg; kUnreachable where there is no walk.
    [[nodiscard]] double value() const { return value_; }
    /// Arcs of the residual graph.
    [[nodiscard]] std::span<const int> walk() const { return walk_; }
    /// A step of the multipliers' ascent from the walk towards the value `target`. Returns false if no step
    /// exists.
    bool step(double target);

    /// The continuation from each arc, at the costs last evaluated. Returns false if the clock expired.
    bool evaluate_backward();
    /// For legs whose cost with offset is below a cutoff. Precondition: backward labels are evaluated.
    [[nodiscard]] LegSearch::Query query() const {
        return {.graph = graph_,
                .residual = *residual_,
                .reduced = reduced_,
                .start = start_,
                .end = end_,
                .backward = backward_};
    }
    [[nodiscard]] double offset() const { return offset_; }

  private:
    void leave_out(std::span<const int> first);
    void reduce_costs();
    void take_cheapest_walk();

    const ArcGraph& graph_;
    SearchClock& clock_;
    const PairRelaxation* relaxation_ = nullptr;
    const ResidualGraph* residual_ = nullptr;
    int kind_ = 0;
    LegBounds bounds_;
    Ascent ascent_;
    Multipliers multipliers_;  ///< on cones
    std::vector<int> none_required_;
    std::vector<char> taken_;             ///< cones of the first leg
    std::vector<std::uint64_t> blocked_;  ///< edges incompatible with it
    std::vector<char> usable_;            ///< by arc
    std::vector<double> start_;
    std::vector<double> end_;
    std::vector<double> reduced_;
    std::vector<double> forward_;
    std::vector<double> backward_;
    std::vector<int> before_;
    std::vector<int> cycles_;
    double offset_ = 0.0;
    double value_ = kUnreachable;
    std::vector<int> walk_;
    Usage usage_;
};

}  // namespace conelane::path_pair
