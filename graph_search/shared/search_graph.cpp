#include "graph_search/shared/search_graph.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace conelane {
namespace {

/// For each directed edge, including what NextVertexDecider keeps for it.
constexpr std::size_t kBytesPerEdge = 32;

}  // namespace

void SearchGraph::build(std::span<const Point> points, double d_max_m) {
    SearchBudget unlimited;
    unlimited.memory_limit_bytes = std::numeric_limits<std::size_t>::max();
    (void)build(points, d_max_m, unlimited);
}

bool SearchGraph::build(std::span<const Point> points, double d_max_m, SearchBudget& budget) {
    points_.assign(points.begin(), points.end());
    neighbours_.clear();
    first_edge_.assign(1, 0);

    // A sorted list of occupied square cells of width d_max. Cells stay floating-point numbers, so that no
    // position, however far away, overflows an integer.
    Point origin{0.0, 0.0};
    if (!points.empty()) origin = points.front();
    cells_.clear();
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Point offset = (points[i] - origin) / d_max_m;
        cells_.push_back({std::floor(offset.x()), std::floor(offset.y()), static_cast<Vertex>(i)});
    }
    cell_of_ = cells_;
    std::ranges::sort(cells_);

    const double squared_d_max = d_max_m * d_max_m;
    for (const Cell& own : cell_of_) {
        const auto first = static_cast<std::ptrdiff_t>(neighbours_.size());
        std::size_t compared = 0;
        for (const double column : {own.column - 1.0, own.column, own.column + 1.0}) {
            const double last_row = own.row + 1.0;
            auto cell = std::ranges::lower_bound(cells_, Cell{column, own.row - 1.0, 0});
            const auto begin = cell;
            for (; cell != cells_.end() && cell->column == column && cell->row <= last_row; ++cell) {
                const double squared_distance = (points_[cell->vertex] - points_[own.vertex]).squaredNorm();
                if (squared_distance > 0.0 && squared_distance <= squared_d_max) {
                    neighbours_.push_back(cell->vertex);
                }
            }
            compared += static_cast<std::size_t>(cell - begin);
        }
        std::sort(neighbours_.begin() + first, neighbours_.end());
        // Beyond 2^53 cells, a column and the next one have the same number.
        neighbours_.erase(std::unique(neighbours_.begin() + first, neighbours_.end()), neighbours_.end());
        first_edge_.push_back(static_cast<DirectedEdge>(neighbours_.size()));
        const std::size_t added = neighbours_.size() - static_cast<std::size_t>(first);
        if (budget.spend(10 + compared / 4 + added) || budget.occupy(kBytesPerEdge * neighbours_.size())) {
            points_.clear();
            return false;
        }
    }
    neighbour_x_.resize(neighbours_.size() + kSpare);
    neighbour_y_.resize(neighbours_.size() + kSpare);
    for (std::size_t i = 0; i < neighbours_.size(); ++i) {
        neighbour_x_[i] = points_[neighbours_[i]].x();
        neighbour_y_[i] = points_[neighbours_[i]].y();
    }
    return true;
}

}  // namespace conelane
