#include "evaluation/world/false_positives.hpp"

#include "conelane/invalid_input.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <boost/random/uniform_01.hpp>
#include <boost/random/uniform_int_distribution.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <fmt/format.h>

namespace conelane {
namespace {

constexpr std::array kFalseColors{ConeColor::blue, ConeColor::yellow, ConeColor::unknown};

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

FalsePositives::FalsePositives(const Course& course, bool with_color)
    : space_(id_space(course.track)), with_color_(with_color) {
    for (const Cone& cone : course.cones) used_.insert(cone.id);
}

Cone FalsePositives::draw(const Point& position, SceneGenerator& random) {
    boost::random::uniform_int_distribution<std::size_t> any_color(0, kFalseColors.size() - 1);
    Cone cone;
    cone.position = position;
    cone.id = draw_new_id(random, space_, used_);
    const ConeColor color = kFalseColors[any_color(random)];
    if (with_color_) cone.color = color;
    return cone;
}

long false_positives_to(double seen, double rate) {
    return std::lround(rate * seen / (1.0 - rate));
}

std::vector<Cone> persistent_false_positives(const Course& course, const SceneOptions& options,
                                             const Condition& condition, double rate, double range_m) {
    if (!condition.persistent) return {};
    std::vector<PersistentView> views;
    for (const Viewpoint& viewpoint : course.lap) {
        PersistentView view{{viewpoint.pose.position, viewpoint.pose.heading(), range_m}};
        const auto in_view = std::ranges::count_if(places_of(course, viewpoint), [&](const auto& place) {
            return place && view.view.contains(*place);
        });
        const double seen = (1.0 - condition.miss_rate) * static_cast<double>(in_view);
        view.expected_points = static_cast<double>(false_positives_to(seen, rate));
        views.push_back(view);
    }
    SceneGenerator random = generator_for(fmt::format("{}/{}/{}/{}/persistent false positives",
                                                      course.track.name, rate, range_m, options.seed));
    const std::vector<Point> points = draw_persistent_points(views, random);
    const auto ids_left = id_space(course.track) - static_cast<std::int64_t>(course.cones.size());
    if (static_cast<std::int64_t>(points.size()) > ids_left / 2) {
        throw InvalidInput("fp",
                           fmt::format("{} gives {} false positives that persist around {}; there is room "
                                       "for {}",
                                       rate, points.size(), course.track.name, ids_left / 2));
    }
    FalsePositives false_positives(course, options.with_color);
    std::vector<Cone> cones;
    for (const Point& point : points) cones.push_back(false_positives.draw(rounded(point), random));
    return cones;
}

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
