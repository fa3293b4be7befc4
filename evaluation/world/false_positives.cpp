#include "evaluation/world/false_positives.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/world/persistent_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <boost/random/uniform_int_distribution.hpp>
#include <fmt/format.h>

namespace conelane {
namespace {

constexpr std::array kFalseColors{ConeColor::blue, ConeColor::yellow, ConeColor::unknown};

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

}  // namespace conelane
