#pragma once

#include "solvers/path_pair/graph/residual_graph.hpp"

namespace conelane::path_pair {

/// Sets of pairwise incompatible edges: a lane graph holds at most one edge of each.
class CliquePool {
  public:
    void clear();
    [[nodiscard]] int size() const { return static_cast<int>(start_.size()) - 1; }
    [[nodiscard]] std::span<const int> edges(int clique) const {
        return {edges_.data() + start_[to_index(clique)], edges_.data() + start_[to_index(clique) + 1]};
    }
    /// Returns false if the pool has it already. Precondition: edges in ascending order.
    bool add(std::span<const int> clique);

  private:
    std::vector<std::size_t> start_{0};
    std::vector<int> edges_;
};

/// Finds cliques of incompatible edges whose averaged uses x add up to more than 1. A clique grows greedily
/// from each edge in use, largest x first, then is extended to a maximal clique of the residual graph.
class CliqueSeparation {
  public:
    /// Returns the number of cliques added to the pool, at most `most`; fewer if the clock expires.
    int separate(const ArcGraph& graph, std::span<const double> edge_use, std::span<const char> edge_alive,
                 int most, CliquePool& pool, SearchClock& clock);

  private:
    std::vector<int> used_;
    std::vector<int> clique_;
    std::vector<std::uint64_t> common_;  ///< edges that are incompatible with all edges of the clique
    std::vector<char> covered_;
};

/// Multipliers of the rows that couple the legs,
///     visits of cone v <= 1 (= 1 if an edge at v is required)     cone[v] >= 0 (of any sign)
///     edges of clique q <= 1                                         clique[q] >= 0
///     edges along the heading >= 2                                   heading >= 0.
/// With any such multipliers, min (cost of two legs + multiplier * violation) bounds every lane graph from
/// below. The two legs remain walks, over arcs of reduced cost: see `reduce`.
struct Multipliers {
    std::vector<double> cone;
    std::vector<double> clique;
    double heading = 0.0;

    /// Sum of multiplier times right-hand side over the rows: the bound is the reduced costs of both legs
    /// minus this sum.
    [[nodiscard]] double offset() const;
};

/// How often two legs use each row: visits of a cone, edges of a clique, edges along the heading.
struct Usage {
    std::vector<int> cone;
    std::vector<int> clique;
    int along_heading = 0;
};

/// Reduced cost of every residual arc: the cost of its edge, the clique and heading multipliers of the edge
/// and the multiplier of its head. A leg's cost also has the multiplier of its first cone. `edge_multiplier`
/// is scratch.
void reduce(const ArcGraph& graph, const CliquePool& cliques, const Multipliers& multipliers,
            const ResidualGraph& residual, std::vector<double>& edge_multiplier,
            std::vector<double>& reduced);

/// Deflected subgradient ascent (Camerini, Fratta, Maffioli 1975) with Polyak's step
///     multipliers += scale (target - bound) / |d|^2 d,   d = violation + theta d_before,
/// and theta keeps d from pointing back along d_before.
class Ascent {
  public:
    /// The next step uses only its own violation.
    void restart(const Multipliers& multipliers);
    /// `required` by cone: above 0, the multiplier may have any sign. Returns false, without a step, if no
    /// row is violated or has a multiplier that may fall.
    bool step(Multipliers& multipliers, const Usage& usage, std::span<const int> required, double gap,
              double scale);

  private:
    std::vector<double> direction_;
    std::vector<double> violation_;
};

}  // namespace conelane::path_pair
