#include "graph_search/search_graph.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include <boost/polygon/voronoi.hpp>

namespace conelane {
namespace {

using GridPoint = boost::polygon::point_data<std::int32_t>;

/// Half the extent of the points in units of the grid.
constexpr double kGridRadius = 536870912.0;

std::vector<GridPoint> on_grid(std::span<const Point> points) {
    Point lowest = points.front();
    Point highest = points.front();
    for (const Point& point : points) {
        lowest = lowest.cwiseMin(point);
        highest = highest.cwiseMax(point);
    }
    const Point centre = 0.5 * (lowest + highest);
    const double radius = std::max(0.5 * (highest - lowest).maxCoeff(), std::numeric_limits<double>::min());
    std::vector<GridPoint> rounded;
    rounded.reserve(points.size());
    for (const Point& point : points) {
        const Point units = kGridRadius * ((point - centre) / radius);
        rounded.emplace_back(static_cast<std::int32_t>(std::lround(units.x())),
                             static_cast<std::int32_t>(std::lround(units.y())));
    }
    return rounded;
}

}  // namespace

void SearchGraph::build(std::span<const Point> points, double d_max_m, SearchGraphKind kind) {
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
    std::vector<Cell> cell_of(cells_);
    std::ranges::sort(cells_);

    const double squared_d_max = d_max_m * d_max_m;
    for (const Cell& own : cell_of) {
        const auto first = static_cast<std::ptrdiff_t>(neighbours_.size());
        for (const double column : {own.column - 1.0, own.column, own.column + 1.0}) {
            const double last_row = own.row + 1.0;
            auto cell = std::ranges::lower_bound(cells_, Cell{column, own.row - 1.0, 0});
            for (; cell != cells_.end() && cell->column == column && cell->row <= last_row; ++cell) {
                const double squared_distance = (points_[cell->vertex] - points_[own.vertex]).squaredNorm();
                if (squared_distance > 0.0 && squared_distance <= squared_d_max) {
                    neighbours_.push_back(cell->vertex);
                }
            }
        }
        std::sort(neighbours_.begin() + first, neighbours_.end());
        // Beyond 2^53 cells a column and the next are the same number.
        neighbours_.erase(std::unique(neighbours_.begin() + first, neighbours_.end()), neighbours_.end());
        first_edge_.push_back(static_cast<DirectedEdge>(neighbours_.size()));
    }
    if (kind == SearchGraphKind::delaunay && !points.empty()) keep_delaunay_edges();
    neighbour_x_.resize(neighbours_.size() + kSpare);
    neighbour_y_.resize(neighbours_.size() + kSpare);
    for (std::size_t i = 0; i < neighbours_.size(); ++i) {
        neighbour_x_[i] = points_[neighbours_[i]].x();
        neighbour_y_[i] = points_[neighbours_[i]].y();
    }
}

void SearchGraph::keep_delaunay_edges() {
    const std::vector<GridPoint> sites = on_grid(points_);
    boost::polygon::voronoi_diagram<double> diagram;
    boost::polygon::construct_voronoi(sites.begin(), sites.end(), &diagram);
    std::vector<std::pair<Vertex, Vertex>> joined;
    for (const auto& edge : diagram.edges()) {
        joined.emplace_back(static_cast<Vertex>(edge.cell()->source_index()),
                            static_cast<Vertex>(edge.twin()->cell()->source_index()));
    }
    std::ranges::sort(joined);
    std::vector<Vertex> kept;
    std::vector<DirectedEdge> first_kept(1, 0);
    for (Vertex vertex = 0; vertex < vertex_count(); ++vertex) {
        for (const Vertex neighbour : neighbours(vertex)) {
            if (std::ranges::binary_search(joined, std::pair(vertex, neighbour))) kept.push_back(neighbour);
        }
        first_kept.push_back(static_cast<DirectedEdge>(kept.size()));
    }
    neighbours_ = std::move(kept);
    first_edge_ = std::move(first_kept);
}

bool SearchGraph::adjacent(Vertex a, Vertex b) const {
    return std::ranges::binary_search(neighbours(a), b);
}

}  // namespace conelane
