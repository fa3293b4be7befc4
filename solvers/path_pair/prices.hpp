#pragma once

#include "solvers/path_pair/arc_graph.hpp"
#include "solvers/path_pair/residual_graph.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace conelane::path_pair {

/// Sets of pairwise incompatible edges: a lane graph holds at most one edge of each.
class CliquePool {
  public:
    void clear();
    [[nodiscard]] int size() const { return static_cast<int>(start_.size()) - 1; }
    [[nodiscard]] std::span<const int> edges(int clique) const {
        return {edges_.data() + start_[static_cast<std::size_t>(clique)],
                edges_.data() + start_[static_cast<std::size_t>(clique) + 1]};
    }
    /// False where it is there already. Precondition: ascending.
    bool add(std::span<const int> clique);

  private:
    std::vector<std::size_t> start_{0};
    std::vector<int> edges_;
};

/// Multipliers of the rows that couple the legs,
///     visits of cone v <= 1 (= 1 where an edge at v is required)     price cone[v]
///     edges of clique q <= 1                                         price clique[q] >= 0
///     edges along the heading >= 2                                   price heading >= 0.
/// For all prices, min (cost of two legs + price * violation) bounds every lane graph from below; the cost of
/// a leg with prices is again one of a walk: see `reduce`.
struct Prices {
    std::vector<double> cone;
    std::vector<double> clique;
    double heading = 0.0;

    /// Sum of the prices' right-hand sides: the bound is both legs' reduced costs minus this.
    [[nodiscard]] double offset() const;
};

/// How often two legs use what has a price.
struct Usage {
    std::vector<int> cone;
    std::vector<int> clique;
    int along_heading = 0;
};

/// Reduced cost of every residual arc: its edge with clique and heading prices, and the price of its head. A
/// leg also pays for the cone it starts from. `edge_price` is scratch.
void reduce(const ArcGraph& graph, const CliquePool& cliques, const Prices& prices,
            const ResidualGraph& residual, std::vector<double>& edge_price, std::vector<double>& reduced);

/// Deflected subgradient ascent (Camerini, Fratta, Maffioli 1975) with Polyak's step
///     prices += scale (target - bound) / |d|^2 d,   d = violation + theta d_before,
/// theta such that d never points back along d_before.
class Ascent {
  public:
    void restart(const Prices& prices);
    /// `required` by cone: its price has no sign.
    void step(Prices& prices, const Usage& usage, std::span<const int> required, double gap, double scale);

  private:
    std::vector<double> direction_;
    std::vector<double> violation_;
};

}  // namespace conelane::path_pair
