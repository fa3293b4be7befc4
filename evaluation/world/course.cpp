#include "evaluation/world/course.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/world/centre_line.hpp"

#include <array>
#include <limits>
#include <numbers>
#include <utility>

#include <boost/random/uniform_01.hpp>
#include <boost/random/uniform_int_distribution.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <fmt/format.h>

namespace conelane {
namespace {

constexpr std::int64_t kMinIdSpace = 10'000;
constexpr std::int64_t kIdsPerCone = 128;

/// A boundary's run in a scene, and whether it shows the whole boundary.
struct Run {
    std::vector<ConeId> ids;
    bool whole = true;
};

/// The run of seen cones from the first one at or past the car's foot point on the boundary. It continues
/// past missed cones and single cones that the map lacks, and ends before the first cone out of view.
Run run_ahead(const Course& course, const std::vector<std::size_t>& side, const std::vector<Point>& polyline,
              const std::vector<Sight>& sights, const Point& car) {
    const PolylineFoot foot = foot_on_polyline(car, polyline, course.track.closed);
    const bool at_vertex = (foot.point - polyline[foot.segment]).norm() <= kTieTolerance;
    // An open boundary of one cone has no next vertex, so its vertex is the foot.
    const std::size_t first = at_vertex ? foot.segment : foot.segment + 1;
    const std::size_t steps = course.track.closed ? side.size() : side.size() - first;
    Run run;
    bool lacked_one = false;
    for (std::size_t step = 0; step < steps; ++step) {
        const std::size_t cone = side[(first + step) % side.size()];
        const bool lacked = sights[cone] == Sight::unmapped;
        if (sights[cone] == Sight::seen) {
            run.ids.push_back(course.cones[cone].id);
        } else if (!run.ids.empty() && (sights[cone] == Sight::out_of_view || (lacked && lacked_one))) {
            break;
        }
        lacked_one = lacked;
    }
    run.whole = std::ranges::none_of(side, [&](std::size_t cone) {
        return sights[cone] == Sight::out_of_view || sights[cone] == Sight::unmapped;
    });
    return run;
}

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

std::int64_t id_space(const Track& track) {
    return std::max(kMinIdSpace, kIdsPerCone * static_cast<std::int64_t>(track.cones.size()));
}

ConeId draw_new_id(SceneGenerator& generator, std::int64_t space, std::unordered_set<ConeId>& used) {
    boost::random::uniform_int_distribution<ConeId> any(0, space - 1);
    ConeId id = any(generator);
    while (!used.insert(id).second) id = any(generator);
    return id;
}

Course make_course(const Track& track, const SceneOptions& options) {
    Course course{
        .track = track, .polylines = boundaries(track), .cones = track.cones, .boundary_ids = {}, .lap = {}};
    SceneGenerator generator = generator_for(fmt::format("{}/{}/ids", track.name, options.seed));
    std::unordered_set<ConeId> used;
    for (Cone& cone : course.cones) {
        cone.id = draw_new_id(generator, id_space(track), used);
        cone.confidence = 1.0;
        if (!options.with_color) cone.color = ConeColor::unknown;
    }
    for (const std::vector<std::size_t>* side : {&track.left, &track.right}) {
        for (const std::size_t index : *side) course.boundary_ids.insert(course.cones[index].id);
    }
    if (options.with_color) {
        const auto paint = [&](const std::vector<std::size_t>& side, ConeColor color) {
            for (const std::size_t index : side) {
                if (!is_orange(course.cones[index].color)) course.cones[index].color = color;
            }
        };
        paint(track.left, ConeColor::blue);
        paint(track.right, ConeColor::yellow);
    }
    return course;
}

std::vector<Viewpoint> viewpoints_at(std::span<const Pose> poses) {
    std::vector<Viewpoint> viewpoints;
    for (const Pose& pose : poses) viewpoints.push_back({pose});
    return viewpoints;
}

std::vector<Viewpoint> viewpoints_along(const Track& track, double every_m) {
    if (track.frames.empty()) return viewpoints_at(centre_line_poses(boundaries(track), every_m));
    std::vector<Viewpoint> viewpoints;
    double steps = 0.0;  // in units of every_m, to the place of the next frame
    for (const RunFrame& frame : track.frames) {
        if (frame.travelled_m < steps * every_m) continue;
        viewpoints.push_back({frame.pose, &frame});
        steps = std::floor(frame.travelled_m / every_m) + 1.0;
    }
    return viewpoints;
}

std::vector<std::optional<Point>> places_of(const Course& course, const Viewpoint& viewpoint) {
    std::vector<std::optional<Point>> places(course.cones.size());
    if (viewpoint.frame != nullptr) {
        for (const MapPlace& place : viewpoint.frame->map) places[place.cone] = place.position;
    } else {
        std::ranges::transform(course.cones, places.begin(), &Cone::position);
    }
    return places;
}

Lane seen_lane(const Course& course, const std::vector<Sight>& sights, const Point& car) {
    const Track& track = course.track;
    Run left = run_ahead(course, track.left, course.polylines.left, sights, car);
    Run right = run_ahead(course, track.right, course.polylines.right, sights, car);
    return {std::move(left.ids), std::move(right.ids), track.closed && left.whole && right.whole};
}

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
