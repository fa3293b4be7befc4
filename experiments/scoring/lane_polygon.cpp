#include "experiments/scoring/lane_polygon.hpp"

#include "model/geometry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <boost/polygon/polygon.hpp>

namespace conelane::experiments {
namespace {

namespace bp = boost::polygon;

// Integer coordinates: Boost.Polygon's overlay of them is robust for every input, a floating-point overlay
// is not. Below 2^30 its products stay exact.
using Coordinate = int;
using Region = bp::polygon_set_data<Coordinate>;
constexpr double kUnitsPerMetre = 1e6;
constexpr double kLargestCoordinate = 1e9;

bool has_region(const LaneOutline& lane) {
    return lane.left.size() >= 2 && lane.right.size() >= 2;
}

/// The integer grid that both lanes of a comparison share, centred on their bounding box.
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
        return std::min(kUnitsPerMetre, kLargestCoordinate / half_extent_m);
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
    Point lowest_ = Point::Constant(std::numeric_limits<double>::infinity());
    Point highest_ = Point::Constant(-std::numeric_limits<double>::infinity());
};

/// Declaring every loop clockwise makes a clockwise turn count +1 and a counter-clockwise one -1, and the
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
    using namespace bp::operators;
    Region shared;
    shared = region_a & region_b;
    const double intersection = area_units(shared);
    if (intersection == 0.0) return 0.0;
    Region either;
    either = region_a | region_b;
    return std::min(1.0, intersection / area_units(either));
}

}  // namespace conelane::experiments
