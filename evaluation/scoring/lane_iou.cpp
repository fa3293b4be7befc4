#include "evaluation/scoring/lane_iou.hpp"

#include "model/geometry.hpp"

#include <limits>

#include <boost/polygon/polygon.hpp>

namespace conelane {
namespace {

namespace bp = boost::polygon;

// Integer coordinates: the overlay of Boost.Polygon is robust for all integer input, but not for
// floating-point input. Below 2^30 its products are exact.
using Coordinate = int;
using Region = bp::polygon_set_data<Coordinate>;
constexpr double kUnitsPerMetre = 1e6;
constexpr double kMaxCoordinate = 1e9;

bool has_region(const LaneOutline& lane) {
    return lane.left.size() >= 2 && lane.right.size() >= 2;
}

/// The integer grid shared by both lanes of a comparison, centred on their bounding box.
class Grid {
  public:
    void cover(const LaneOutline& lane) {
        for (const std::vector<Point>* side : {&lane.left, &lane.right}) {
            for (const Point& vertex : *side) {
                lowest_ = lowest_.cwiseMin(vertex);
                highest_ = highest_.cwiseMax(vertex);
            }
        }
    }
    /// Precondition: a vertex was covered.
    [[nodiscard]] double units_per_metre() const {
        const double half_extent_m = 0.5 * (highest_ - lowest_).maxCoeff();
        return std::min(kUnitsPerMetre, kMaxCoordinate / half_extent_m);
    }
    [[nodiscard]] std::vector<bp::point_data<Coordinate>> rounded(const std::vector<Point>& vertices) const {
        const Point centre = 0.5 * (lowest_ + highest_);
        const double scale = units_per_metre();
        std::vector<bp::point_data<Coordinate>> result;
        result.reserve(vertices.size());
        for (const Point& vertex : vertices) {
            const Point units = scale * (vertex - centre);
            result.emplace_back(static_cast<Coordinate>(std::lround(units.x())),
                                static_cast<Coordinate>(std::lround(units.y())));
        }
        return result;
    }

  private:
    static constexpr double kInfinity_m = std::numeric_limits<double>::infinity();
    Point lowest_{kInfinity_m, kInfinity_m};
    Point highest_{-kInfinity_m, -kInfinity_m};
};

/// All loops are declared clockwise, so a clockwise turn counts +1 and a counter-clockwise turn -1; the
/// overlay keeps the points with a positive sum.
void insert_loop(Region& region, const std::vector<bp::point_data<Coordinate>>& loop) {
    region.insert_vertex_sequence(loop.begin(), loop.end(), bp::CLOCKWISE, false);
}

Region region_of(const LaneOutline& lane, const Grid& grid) {
    Region region;
    if (!has_region(lane)) return region;
    std::vector<bp::point_data<Coordinate>> left = grid.rounded(lane.left);
    std::vector<bp::point_data<Coordinate>> right = grid.rounded(lane.right);
    std::ranges::reverse(right);
    if (lane.closed) {
        insert_loop(region, left);
        insert_loop(region, right);
    } else {
        left.insert(left.end(), right.begin(), right.end());
        insert_loop(region, left);
    }
    return region;
}

/// An edge of an outline, from left to right.
struct Edge {
    Point begin;
    double end_x;
    double slope;
    double sign;  ///< 1 if the outline runs to the right, else -1

    [[nodiscard]] double at(double x) const { return begin.y() + slope * (x - begin.x()); }
};

void add_loop(std::span<const Point> loop, std::vector<Edge>& edges) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const Point& from = loop[i];
        const Point& to = loop[(i + 1) % loop.size()];
        if (from.x() == to.x()) continue;
        const bool to_the_right = from.x() < to.x();
        const double slope = (to.y() - from.y()) / (to.x() - from.x());
        edges.push_back(
            {to_the_right ? from : to, std::max(from.x(), to.x()), slope, to_the_right ? 1.0 : -1.0});
    }
}

std::vector<Edge> edges_of(const LaneOutline& lane) {
    std::vector<Point> left = lane.left;
    std::vector<Point> right(lane.right.rbegin(), lane.right.rend());
    std::vector<Edge> edges;
    if (lane.closed) {
        add_loop(left, edges);
        add_loop(right, edges);
    } else {
        left.insert(left.end(), right.begin(), right.end());
        add_loop(left, edges);
    }
    return edges;
}

/// Integral over the plane of the product of the winding numbers of both outlines. The winding number of a
/// point is the sum of the signs of the edges above it, so the integral is a sum over pairs of edges: the
/// area below both, with sign. `floor_m`: a height below all edges.
double shared_area_m2(std::span<const Edge> a, std::span<const Edge> b, double floor_m) {
    double area_m2 = 0.0;
    for (const Edge& e : a) {
        for (const Edge& f : b) {
            const double from = std::max(e.begin.x(), f.begin.x());
            const double to = std::min(e.end_x, f.end_x);
            if (from >= to) continue;
            // The trapezoid below the lower edge; two trapezoids if the edges cross.
            const double e_from = e.at(from) - floor_m;
            const double e_to = e.at(to) - floor_m;
            const double above_from = e_from - (f.at(from) - floor_m);
            const double above_to = e_to - (f.at(to) - floor_m);
            double below = (e_from + e_to) / 2.0 * (to - from);
            if (above_from > 0.0 && above_to > 0.0) {
                below -= (above_from + above_to) / 2.0 * (to - from);
            } else if (above_from > 0.0 || above_to > 0.0) {
                const double above = std::max(above_from, above_to);
                below -= above / 2.0 * (to - from) * above / std::abs(above_from - above_to);
            }
            area_m2 += e.sign * f.sign * below;
        }
    }
    return area_m2;
}

double area_units(const Region& region) {
    return static_cast<double>(bp::area(region));
}

}  // namespace

double lane_length_m(const LaneOutline& lane) {
    return 0.5 * (polyline_length_m(lane.left, lane.closed) + polyline_length_m(lane.right, lane.closed));
}

double lane_area_m2(const LaneOutline& lane) {
    if (!has_region(lane)) return 0.0;
    Grid grid;
    grid.cover(lane);
    const double scale = grid.units_per_metre();
    return area_units(region_of(lane, grid)) / (scale * scale);
}

double intersection_over_union(const LaneOutline& a, const LaneOutline& b) {
    if (!has_region(a) || !has_region(b)) return 0.0;
    Grid grid;
    grid.cover(a);
    grid.cover(b);
    const Region region_a = region_of(a, grid);
    const Region region_b = region_of(b, grid);
    using bp::operators::operator&;
    using bp::operators::operator|;
    Region shared;
    shared = region_a & region_b;
    const double intersection = area_units(shared);
    if (intersection == 0.0) return 0.0;
    Region either;
    either = region_a | region_b;
    return std::min(1.0, intersection / area_units(either));
}

double intersection_over_union_of_simple(const LaneOutline& a, const LaneOutline& b) {
    if (!has_region(a) || !has_region(b)) return 0.0;
    double floor_m = std::numeric_limits<double>::infinity();
    for (const std::vector<Point>* side : {&a.left, &a.right, &b.left, &b.right}) {
        for (const Point& vertex : *side) floor_m = std::min(floor_m, vertex.y());
    }
    const std::vector<Edge> edges_a = edges_of(a);
    const std::vector<Edge> edges_b = edges_of(b);
    const double shared_m2 = shared_area_m2(edges_a, edges_b, floor_m);
    if (!(shared_m2 > 0.0)) return 0.0;
    const auto area_m2 = [&](const std::vector<Edge>& edges) {
        double sum_m2 = 0.0;
        for (const Edge& edge : edges) {
            const double mean_height_m = (edge.begin.y() + edge.at(edge.end_x)) / 2.0 - floor_m;
            sum_m2 += edge.sign * mean_height_m * (edge.end_x - edge.begin.x());
        }
        return sum_m2;
    };
    return std::min(1.0, shared_m2 / (area_m2(edges_a) + area_m2(edges_b) - shared_m2));
}

}  // namespace conelane
