#include "experiments/delaunay.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <boost/polygon/voronoi.hpp>

namespace conelane::experiments {
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

std::vector<std::pair<Vertex, Vertex>> delaunay_edges(std::span<const Point> points) {
    std::vector<std::pair<Vertex, Vertex>> joined;
    if (points.empty()) return joined;
    const std::vector<GridPoint> sites = on_grid(points);
    boost::polygon::voronoi_diagram<double> diagram;
    boost::polygon::construct_voronoi(sites.begin(), sites.end(), &diagram);
    for (const auto& edge : diagram.edges()) {
        joined.emplace_back(static_cast<Vertex>(edge.cell()->source_index()),
                            static_cast<Vertex>(edge.twin()->cell()->source_index()));
    }
    return joined;
}

}  // namespace conelane::experiments
