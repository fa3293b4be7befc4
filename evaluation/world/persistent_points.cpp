#include "evaluation/world/persistent_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <boost/random/uniform_01.hpp>
#include <boost/random/uniform_real_distribution.hpp>

namespace conelane {
namespace {

/// Mean of the densities that the views containing a point want; 0 if no view contains it.
double mean_expected_points(std::span<const PersistentView> views, const Point& point) {
    double sum = 0.0;
    std::size_t count = 0;
    for (const PersistentView& view : views) {
        if (!view.view.contains(point)) continue;
        sum += view.expected_points;
        ++count;
    }
    return count > 0 ? sum / static_cast<double>(count) : 0.0;
}

}  // namespace

std::vector<Point> draw_persistent_points(std::span<const PersistentView> views,
                                          boost::random::mt19937_64& random) {
    if (views.empty()) return {};
    const double radius_m = views.front().view.radius_m;
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    Point lowest(kInfinite, kInfinite);
    Point highest = -lowest;
    double max_points = 0.0;
    for (const PersistentView& view : views) {
        lowest = lowest.cwiseMin(view.view.centre);
        highest = highest.cwiseMax(view.view.centre);
        max_points = std::max(max_points, view.expected_points);
    }
    if (!(max_points > 0.0)) return {};

    // Thinning: draws points over the whole box at the density of the densest view; each is kept with the
    // probability that its place wants.
    lowest -= Point(radius_m, radius_m);
    highest += Point(radius_m, radius_m);
    const Point size = highest - lowest;
    const double view_m2 = std::numbers::pi * radius_m * radius_m / 2.0;
    const auto count = std::lround(max_points * size.x() * size.y() / view_m2);
    boost::random::uniform_real_distribution<double> any_x_m(lowest.x(), highest.x());
    boost::random::uniform_real_distribution<double> any_y_m(lowest.y(), highest.y());
    boost::random::uniform_01<double> uniform;
    std::vector<Point> points;
    for (long i = 0; i < count; ++i) {
        const double x_m = any_x_m(random);
        const double y_m = any_y_m(random);
        const double share = uniform(random);
        const Point point(x_m, y_m);
        if (share * max_points < mean_expected_points(views, point)) points.push_back(point);
    }
    return points;
}

}  // namespace conelane
