#pragma once

#include "conelane/lane_graph_problem.hpp"
#include "solvers/path_pair/graph/bit_matrix.hpp"
#include "solvers/path_pair/search_clock.hpp"

namespace conelane::path_pair {

/// A number of an arc, an edge, a cone or a frontier, as containers take it.
[[nodiscard]] constexpr std::size_t to_index(int number) {
    return static_cast<std::size_t>(number);
}

/// Whether a sum of costs is below another one by more than rounding: without a threshold, a cycle of cost 0
/// could be walked for ever. `cost` is not minus infinity.
[[nodiscard]] inline bool is_cheaper(double cost, double than) {
    return cost + (1e-12 + 1e-14 * std::abs(cost)) < than;
}

/// The problem as a directed graph in which a path's cost is a walk's: every allowed edge e gives the arcs 2
/// e (from its first cone to its second) and 2 e + 1 (back), and every allowed turn two successions of arcs.
/// A leg, one path of the lane graph in one of its directions, is a walk a_1 .. a_k of
///     cost = sum_i cost(a_i) + sum_i turn(a_i, a_i+1).
/// Two edges are incompatible where no lane graph holds both: a width conflict (7) or a forbidden turn (28).
class ArcGraph {
  public:
    struct Succession {
        int arc;      ///< the next one
        double cost;  ///< of the turn
    };

    /// Returns false if the clock expired; there is no graph then.
    bool build(const LaneGraphProblem& problem, SearchClock& clock);

    [[nodiscard]] int cone_count() const { return cone_count_; }
    [[nodiscard]] int edge_count() const { return static_cast<int>(problem_edge_.size()); }
    [[nodiscard]] int arc_count() const { return 2 * edge_count(); }
    [[nodiscard]] int tail(int arc) const { return cone_[to_index(arc)]; }
    [[nodiscard]] int head(int arc) const { return cone_[to_index(arc ^ 1)]; }
    [[nodiscard]] double cost(int edge) const { return cost_[to_index(edge)]; }
    /// h of (9).
    [[nodiscard]] bool along_heading(int edge) const { return along_heading_[to_index(edge)] != 0; }
    [[nodiscard]] std::size_t problem_edge(int edge) const { return problem_edge_[to_index(edge)]; }
    [[nodiscard]] std::span<const Succession> successions(int arc) const {
        return {successions_.data() + start_[to_index(arc)], successions_.data() + start_[to_index(arc) + 1]};
    }
    /// The arc from one cone to another. Precondition: they have an edge.
    [[nodiscard]] int arc(int from, int to) const;
    /// The cost of an allowed turn.
    [[nodiscard]] double turn_cost(int arc, int next) const;

    [[nodiscard]] bool incompatible(int edge, int other) const { return incompatible_.test(edge, other); }
    [[nodiscard]] std::span<const std::uint64_t> incompatible_row(int edge) const {
        return incompatible_.row(edge);
    }
    [[nodiscard]] bool near(int cone) const { return near_[to_index(cone)] != 0; }
    /// Far cones that may end the other path if the far cone `cone` ends this one (17).
    [[nodiscard]] std::span<const int> partners(int cone) const {
        return {partners_.data() + partner_start_[to_index(cone)],
                partners_.data() + partner_start_[to_index(cone) + 1]};
    }
    [[nodiscard]] bool are_partners(int cone, int other) const { return !apart_.test(cone, other); }

    /// A lower bound of every lane graph's cost: each cone's cheapest share, half of its edges and its turn.
    [[nodiscard]] double share_bound() const { return share_bound_; }

  private:
    /// An allowed turn, by the two arcs that leave its middle cone.
    struct Turn {
        int arc_i;
        int arc_k;
        double cost;
    };
    void add_edges(const LaneGraphProblem& problem);
    void exclude(std::size_t first, std::size_t second);
    // False if the clock expired.
    bool add_successions(const LaneGraphProblem& problem, SearchClock& clock);
    bool add_partners(const LaneGraphProblem& problem, SearchClock& clock);
    bool find_share_bound(SearchClock& clock);

    int cone_count_ = 0;
    std::vector<int> cone_;  ///< by arc: its tail
    std::vector<double> cost_;
    std::vector<char> along_heading_;
    std::vector<std::size_t> problem_edge_;
    std::vector<int> edge_of_problem_;
    std::vector<Turn> turns_;
    std::vector<std::size_t> start_;
    std::vector<std::size_t> fill_;
    std::vector<Succession> successions_;
    BitMatrix incompatible_;
    std::vector<char> near_;
    BitMatrix far_;    ///< one row, by cone
    BitMatrix apart_;  ///< pairs that (17) forbids, near cones and a cone with itself
    std::vector<std::size_t> partner_start_;
    std::vector<int> partners_;
    std::vector<double> share_;  ///< by cone, the cheapest
    double share_bound_ = 0.0;
};

}  // namespace conelane::path_pair
