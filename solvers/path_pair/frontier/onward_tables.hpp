#pragma once

#include "solvers/path_pair/frontier/frontier_graph.hpp"

namespace conelane::path_pair {

/// A cost in whole quanta of 1/126 of the gap, rounded down. Sums of two fit in a byte.
using Quanta = std::uint8_t;
inline constexpr Quanta kTooMany = 127;  ///< more than the gap

/// What the ways on from a frontier cost beyond the cheapest one, if they are to use an edge or must do
/// without some. With delta(s) = cost(s) + onward(to) - onward(f), at least 0, of a step s from frontier f to
/// frontier `to`,
///     regret(f, e) = min over s of delta(s) + (s takes e ? 0 : regret(to, e)),      of an edge e,
///     detour(f, a) = min over s that a does not exclude of delta(s) + detour(to, a), of an arc a,
/// and a last frontier may also end there. Multipliers cannot tell a walk on from one that an arc far behind
/// excludes; the detours of a beginning's arcs can.
class OnwardTables {
  public:
    OnwardTables(const FrontierGraph& frontiers, const EdgeSets& edges, SearchClock& clock)
        : frontiers_(frontiers), edges_(edges), clock_(clock) {}

    /// Precondition: the onward costs of the frontiers are found. `limit`: with offset. If the time ends
    /// within the call, the tables are incomplete and must not be used.
    void find(double limit, bool with_detours);

    [[nodiscard]] bool have_detours() const { return have_detours_; }
    /// By number of the edge, in EdgeSets.
    [[nodiscard]] const Quanta* regrets(int frontier) const {
        return regret_.data() + to_index(frontier) * edge_count_;
    }
    [[nodiscard]] Quanta detour(int frontier, int arc) const {
        return detour_[to_index(frontier) * arc_count_ + column_[to_index(arc)]];
    }
    /// Regrets and detours above this reach a limit that is `slack` away.
    [[nodiscard]] int quanta_below(double slack) const;
    /// Bytes of a frontier's rows, at most.
    static std::size_t row_bytes(const ResidualGraph& residual);

  private:
    [[nodiscard]] Quanta more(int frontier, const FrontierGraph::Step& step) const;
    [[nodiscard]] Quanta to_quanta(double cost) const;
    /// Call it before this many bytes of rows are written.
    bool out_of_time(std::size_t bytes);
    bool fill(std::vector<Quanta>& table, std::size_t count);
    /// Lowers the rows of a table from last frontiers back until nothing changes. `lower_end(f, row)` and
    /// `lower_by(step, delta, row)` lower a row, the first one once, and tell whether anything fell.
    template <typename LowerEnd, typename LowerBy>
    void sweep_back(std::vector<Quanta>& table, std::size_t count, const LowerEnd& lower_end,
                    const LowerBy& lower_by);
    void find_regrets();
    void number_arcs();
    void find_excluded();
    void find_detours();

    const FrontierGraph& frontiers_;
    const EdgeSets& edges_;
    SearchClock& clock_;
    bool have_detours_ = false;
    double quantum_ = 1.0;
    std::size_t edge_count_ = 0;       ///< in whole words
    std::size_t arc_count_ = 0;        ///< in whole blocks
    std::vector<Quanta> regret_;       ///< by frontier and edge
    std::vector<Quanta> detour_;       ///< by frontier and column of the arc
    std::vector<std::size_t> column_;  ///< by arc; those of no frontier share one
    std::vector<int> arcs_;            ///< by column
    std::vector<std::array<int, 2>> columns_of_edge_;
    std::vector<Quanta> excluded_;  ///< by arc of a step and column: kTooMany where that arc excludes it
    std::vector<Quanta> nothing_;
    std::vector<int> changed_;  ///< by frontier, the sweep that changed it last
};

}  // namespace conelane::path_pair
