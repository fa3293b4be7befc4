#pragma once

#include "solvers/path_pair/graph/residual_graph.hpp"

namespace conelane::path_pair {

/// Shortest walks over the residual arcs by label correcting,
///     forward(b)  = reduced(b) + min(start(b), min over a before b of forward(a) + turn(a, b))
///     backward(a) = min(end(a), min over b after a of turn(a, b) + reduced(b) + backward(b)),
/// so forward(a) + backward(a) is the cheapest leg through a. A walk is a relaxed path: it may meet a cone
/// twice and hold incompatible edges. Labels are exact up to rounding (is_cheaper) a step.
class LegBounds {
  public:
    /// Both passes end early when the clock expires; the labels are then invalid.
    explicit LegBounds(SearchClock& clock) : clock_(clock) {}

    /// `start` by arc: the cost of starting with it, kUnreachable if a leg must not. Returns false if a walk
    /// gains from an endless cycle; `cycles` then holds the arcs of one or more cycles, each followed by -1.
    /// `before`, the tree of the walks, may be the result of a call with similar costs: the labels start from
    /// its walks. Precondition: if it has the graph's size, its entries are arcs of the graph or -1.
    [[nodiscard]] bool forward(const ResidualGraph& graph, std::span<const double> reduced,
                               std::span<const double> start, std::vector<double>& label,
                               std::vector<int>& before, std::vector<int>& cycles);

    /// `end` by arc: the cost of ending with it. Arcs that `usable` does not mark are ignored. Precondition:
    /// no cycle of usable arcs has a negative cost.
    void backward(const ResidualGraph& graph, std::span<const double> reduced, std::span<const double> end,
                  std::span<const char> usable, std::vector<double>& label);

  private:
    void begin_forward(const ResidualGraph& graph, std::span<const double> reduced,
                       std::span<const double> start, std::vector<double>& label, std::vector<int>& before);
    bool find_cycles(std::span<const int> before, std::vector<int>& cycles);

    SearchClock& clock_;
    std::vector<std::uint64_t> open_;  ///< arcs whose label changed
    std::vector<int> color_;
    std::vector<int> walk_;
};

/// Raises the multipliers of each cycle's cones equally until the cycle costs nothing. A cycle that shares a
/// cone with an earlier one is skipped: it may no longer gain.
void raise_cycles(const ResidualGraph& graph, std::span<const int> cycles, std::span<const double> reduced,
                  std::vector<double>& cone_multiplier);

}  // namespace conelane::path_pair
