#pragma once

#include "graph_search/shared/search_budget.hpp"
#include "model/geometry.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace conelane {

/// A map point, as its index in the scene.
using Vertex = std::uint32_t;

/// The two boundaries of a lane, numbered as in the CLC paper.
using Side = std::size_t;
inline constexpr Side kLeft = 0;
inline constexpr Side kRight = 1;
[[nodiscard]] constexpr Side opposite(Side side) {
    return 1 - side;
}

/// Which points may follow each other on a boundary: the simple undirected graph of equations (1) and (2) of
/// the CLC paper, all pairs at most d_max apart. Two points at the same place are not joined: a segment
/// between them would have no direction. `build` reuses memory from call to call.
class SearchGraph {
  public:
    /// A neighbour together with the number of the directed edge that leads to it.
    using DirectedEdge = std::uint32_t;

    void build(std::span<const Point> points, double d_max_m);
    /// The same within a budget of time and memory. Returns false if it is spent: then there is no graph.
    [[nodiscard]] bool build(std::span<const Point> points, double d_max_m, SearchBudget& budget);

    [[nodiscard]] std::size_t vertex_count() const { return points_.size(); }
    /// Each undirected edge counts twice.
    [[nodiscard]] std::size_t directed_edge_count() const { return neighbours_.size(); }
    [[nodiscard]] const Point& position(Vertex vertex) const { return points_[vertex]; }
    /// Ascending. The k-th neighbour is reached by directed edge first_edge(vertex) + k.
    [[nodiscard]] std::span<const Vertex> neighbours(Vertex vertex) const {
        return {neighbours_.data() + first_edge_[vertex], first_edge_[vertex + 1] - first_edge_[vertex]};
    }
    /// Coordinates of the neighbours, in their order, followed by at least kSpare numbers, so that loops may
    /// end in whole steps.
    struct Positions {
        const double* x;
        const double* y;
        std::size_t size;
    };
    static constexpr std::size_t kSpare = 4;
    [[nodiscard]] Positions neighbour_positions(Vertex vertex) const {
        const DirectedEdge first = first_edge_[vertex];
        return {neighbour_x_.data() + first, neighbour_y_.data() + first, first_edge_[vertex + 1] - first};
    }
    [[nodiscard]] DirectedEdge first_edge(Vertex vertex) const { return first_edge_[vertex]; }

  private:
    struct Cell {
        double column;
        double row;
        Vertex vertex;
        auto operator<=>(const Cell&) const = default;
    };

    std::vector<Point> points_;
    std::vector<DirectedEdge> first_edge_;  ///< vertex_count + 1 entries
    std::vector<Vertex> neighbours_;
    std::vector<double> neighbour_x_;  ///< kSpare more than there are neighbours
    std::vector<double> neighbour_y_;
    std::vector<Cell> cell_of_;  ///< by point
    std::vector<Cell> cells_;    ///< the same in their own order
};

}  // namespace conelane
