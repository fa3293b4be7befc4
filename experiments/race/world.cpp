#include "experiments/race/world.hpp"

#include "detectors/planner/lane_stretch.hpp"
#include "evaluation/seeded_random.hpp"
#include "evaluation/world/course.hpp"

#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_01.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <fmt/format.h>

namespace conelane::experiments {
namespace {

/// Travel between the poses whose views decide where persistent false positives are, as in scenes.
constexpr double kViewStep_m = 1.1;

Point rotated(const Point& point, double angle_rad) {
    const double c = std::cos(angle_rad);
    const double s = std::sin(angle_rad);
    return {c * point.x() - s * point.y(), s * point.x() + c * point.y()};
}

HalfDisc view_from(const Pose& pose, double range_m) {
    return {pose.position, pose.heading(), range_m};
}

std::string key_of(const RaceCourse& course, const SightOptions& options, const std::string& purpose) {
    return fmt::format("{}/{}/{}/{}/{}", course.name, options.condition.name, options.false_positive_rate,
                       options.range_m, purpose);
}

/// Longest travel along the path between two calls [m].
constexpr double kMaxProgress_m = 3.0;

Point target_at(std::span<const Point> path, double arc_length_m) {
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
        const double segment_m = (path[i + 1] - path[i]).norm();
        if (arc_length_m < segment_m) return path[i] + arc_length_m / segment_m * (path[i + 1] - path[i]);
        arc_length_m -= segment_m;
    }
    // Behind its end, a path continues straight, so that a short path keeps its direction.
    const Point last = path.back() - path[path.size() - 2];
    return last.norm() > 0.0 ? Point(path.back() + arc_length_m * last.normalized()) : path.back();
}

}  // namespace

Point MapFrame::to_map(const Point& world) const {
    return rotated(world, yaw_rad) + shift;
}

Point MapFrame::to_world(const Point& map) const {
    return rotated(map - shift, -yaw_rad);
}

Pose MapFrame::to_map(const Pose& world) const {
    return {to_map(world.position), world.yaw_rad + yaw_rad};
}

MapFrame MapFrame::turned(double angle_rad, const Point& about, const Point& moved) const {
    const Point centre = to_map(about);
    return {yaw_rad + angle_rad, rotated(shift - centre, angle_rad) + centre + moved};
}

World::World(const RaceCourse& course, const SightOptions& options)
    : options_(options),
      points_(course.cones),
      random_(generator_of(key_of(course, options, "race"), options.seed)) {
    for (Cone& cone : points_) {
        if (!options_.with_color) cone.color = ConeColor::unknown;
        cone.confidence = 1.0;
    }
    if (options_.condition.persistent) add_persistent(course);
    // Neither ids nor their order reveal what a point is.
    id_space_ = std::max<ConeId>(100'000, 256 * static_cast<ConeId>(points_.size()));
    change_ids();
}

ConeId World::new_id() {
    boost::random::uniform_int_distribution<ConeId> any(0, id_space_ - 1);
    for (;;) {
        const ConeId id = any(random_);
        const auto place = std::ranges::lower_bound(used_ids_, id);
        if (place != used_ids_.end() && *place == id) continue;
        used_ids_.insert(place, id);
        // Fresh false positives use new ids in every frame, so there is room for as many again.
        if (used_ids_.size() * 4 > static_cast<std::size_t>(id_space_)) id_space_ *= 2;
        return id;
    }
}

void World::change_ids() {
    for (Cone& point : points_) point.id = options_.with_ids ? new_id() : kNoId;
}

Pose World::disturbed(const Pose& truth, double step_s) {
    const Condition& condition = options_.condition;
    boost::random::normal_distribution<double> normal;
    std::array<double, 2> error{};
    for (double& part : error) part = normal(random_);
    if (pose_error_ && options_.pose_time_s > 0.0) {
        const double kept = std::exp(-step_s / options_.pose_time_s);
        for (std::size_t i = 0; i < error.size(); ++i)
            error[i] = kept * (*pose_error_)[i] + std::sqrt(1.0 - kept * kept) * error[i];
    }
    pose_error_ = error;
    const double to_left_m = condition.pose_noise_lateral_m * error[0];
    const double yaw_rad = condition.pose_noise_yaw_rad * error[1];
    return {truth.position + to_left_m * Point(-truth.heading().y(), truth.heading().x()),
            truth.yaw_rad + yaw_rad};
}

Frame World::look(const Pose& believed, const MapFrame& map, double time_s) {
    const Condition& condition = options_.condition;
    Frame frame{time_s, map.to_map(believed), {}};
    frame.pose.yaw_rad = std::remainder(frame.pose.yaw_rad, 2.0 * std::acos(-1.0));
    boost::random::normal_distribution<double> normal;
    boost::random::uniform_01<double> uniform;
    for (const Cone& point : points_) {
        if (!sees(believed, point.position)) continue;
        if (uniform(random_) < condition.miss_rate) continue;
        Cone seen = point;
        const double distance_m = (point.position - believed.position).norm();
        const double sigma_m = condition.noise_sigma_m + options_.noise_by_range * distance_m;
        const double x_m = sigma_m * normal(random_);
        const double y_m = sigma_m * normal(random_);
        seen.position = map.to_map(Point(seen.position + Point(x_m, y_m)));
        frame.cones.push_back(seen);
    }
    if (!condition.persistent) add_fresh(frame.cones, believed, map);
    shuffle(frame.cones, random_);
    return frame;
}

bool World::sees(const Pose& believed, const Point& place) const {
    const double bearing_rad = std::atan2(believed.left_m(place), believed.ahead_m(place));
    return view_from(believed, options_.range_m).contains(place) &&
           2.0 * std::abs(bearing_rad) <= options_.fov_rad + 1e-9;
}

double World::false_to(double seen) const {
    const double rate = options_.false_positive_rate;
    return std::round(rate * seen / (1.0 - rate));
}

Cone World::false_positive(const Point& position) {
    constexpr std::array kColors{ConeColor::blue, ConeColor::yellow, ConeColor::unknown};
    boost::random::uniform_int_distribution<std::size_t> any(0, kColors.size() - 1);
    Cone cone{kNoId, position};
    const ConeColor color = kColors[any(random_)];
    if (options_.with_color) cone.color = color;
    return cone;
}

void World::add_persistent(const RaceCourse& course) {
    std::vector<PersistentView> views;
    const auto every = static_cast<std::size_t>(std::lround(kViewStep_m / course.step_m));
    for (std::size_t i = 0; i < course.line.size(); i += every) {
        PersistentView view{view_from(course.line[i], options_.range_m)};
        const auto in_view = std::ranges::count_if(
            course.cones, [&](const Cone& cone) { return view.view.contains(cone.position); });
        // False positives are missed as often as cones: so their share is that among all points.
        view.expected_points = false_to(static_cast<double>(in_view));
        views.push_back(view);
    }
    // Drawn by a generator of their own, so that they do not depend on other draws.
    Generator random = generator_of(key_of(course, options_, "persistent false positives"), options_.seed);
    false_positives_ = draw_persistent_points(views, random);
    for (const Point& point : false_positives_) points_.push_back(false_positive(point));
}

void World::add_fresh(std::vector<Cone>& cones, const Pose& believed, const MapFrame& map) {
    const HalfDisc view = view_from(believed, options_.range_m);
    const auto count = static_cast<long>(false_to(static_cast<double>(cones.size())));
    boost::random::uniform_real_distribution<double> any_m(-view.radius_m, view.radius_m);
    for (long i = 0; i < count;) {
        const double x_m = any_m(random_);
        const double y_m = any_m(random_);
        const Point point = view.centre + Point(x_m, y_m);
        if (!sees(believed, point)) continue;
        cones.push_back(false_positive(map.to_map(point)));
        if (options_.with_ids) cones.back().id = new_id();
        ++i;
    }
}

void Vehicle::drive(double speed_mps, double wanted_rad, double time_s, const SteeringLimits& limits) {
    const double target_rad = std::clamp(wanted_rad, -limits.max_steering_rad, limits.max_steering_rad);
    const double change_rad = limits.max_steering_rate_radps * time_s;
    steering_rad += std::clamp(target_rad - steering_rad, -change_rad, change_rad);
    const double turn_rad = speed_mps * std::tan(steering_rad) / limits.wheelbase_m * time_s;
    const double yaw_rad = pose.yaw_rad + turn_rad / 2.0;  // midpoint rule
    pose.position += speed_mps * time_s * Point(std::cos(yaw_rad), std::sin(yaw_rad));
    pose.yaw_rad = std::remainder(pose.yaw_rad + turn_rad, 2.0 * std::acos(-1.0));
}

double pursue(const Pose& car, std::span<const Point> path, double lookahead_m, double& from_m,
              const SteeringLimits& limits) {
    if (path.size() < 2) return 0.0;
    double best_m = from_m;
    double best_distance_m = std::numeric_limits<double>::infinity();
    double begin_m = 0.0;
    for (std::size_t i = 0; i + 1 < path.size() && begin_m <= from_m + kMaxProgress_m; ++i) {
        const Point along = path[i + 1] - path[i];
        const double segment_m = along.norm();
        if (segment_m > 0.0 && begin_m + segment_m >= from_m) {
            const double on_m = std::clamp((car.position - path[i]).dot(along) / segment_m, 0.0, segment_m);
            const double at_m = std::clamp(begin_m + on_m, from_m, from_m + kMaxProgress_m);
            const Point foot = path[i] + (at_m - begin_m) / segment_m * along;
            if (const double distance_m = (foot - car.position).norm(); distance_m < best_distance_m) {
                best_distance_m = distance_m;
                best_m = at_m;
            }
        }
        begin_m += segment_m;
    }
    from_m = best_m;
    const Point target = target_at(path, from_m + lookahead_m);
    const double distance_m = (target - car.position).norm();
    if (distance_m < 1e-6) return 0.0;
    const double curvature_1pm = 2.0 * car.left_m(target) / (distance_m * distance_m);
    return std::atan(limits.wheelbase_m * curvature_1pm);
}

DrivableLane lane_along(const std::vector<Point>& path) {
    DrivableLane lane;
    for (std::size_t i = 0; i < path.size(); ++i) {
        const Point step = path[std::min(i + 1, path.size() - 1)] - path[i];
        lane.points.push_back({.s_m = lane.length_m, .heading_rad = std::atan2(step.y(), step.x())});
        lane.length_m += step.norm();
    }
    if (path.size() > 1) lane.points.back().heading_rad = lane.points[path.size() - 2].heading_rad;
    even_curvatures(lane);
    return lane;
}

std::vector<Point> beginning(const std::vector<Point>& path, double length_m) {
    std::vector<Point> points;
    double along_m = 0.0;
    for (const Point& point : path) {
        if (!points.empty()) along_m += (point - points.back()).norm();
        points.push_back(point);
        if (along_m >= length_m) break;
    }
    return points;
}

}  // namespace conelane::experiments
