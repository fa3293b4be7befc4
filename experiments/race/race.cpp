#include "experiments/race/race.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/scenes/half_disc.hpp"
#include "evaluation/scenes/persistent_points.hpp"
#include "evaluation/seeded_random.hpp"
#include "evaluation/tracks/centre_line.hpp"
#include "experiments/race/vehicle.hpp"
#include "model/geometry.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <string>

#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_01.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <fmt/format.h>

namespace conelane::experiments {
namespace {

using Generator = boost::random::mt19937_64;

constexpr double kStep_s = 0.01;
constexpr int kStepsPerFrame = 10;  // 10 Hz
constexpr double kOldestPath_s = 1.0;
constexpr double kLineStep_m = 0.25;
constexpr double kHalfWidth_m = 0.75;
constexpr double kHalfLength_m = 1.4;
constexpr double kMiddleAhead_m = 0.775;  ///< of the rear axle
constexpr double kUnsteady_m = 0.3;
constexpr double kSteadyWithin_m = 10.0;
constexpr double kTruthAhead_m = 20.0;

double lookahead_m(double speed_mps) {
    return std::clamp(0.5 * speed_mps, 2.0, 6.0);
}

std::vector<Point> positions(const std::vector<Pose>& poses) {
    std::vector<Point> points;
    for (const Pose& pose : poses) points.push_back(pose.position);
    return points;
}

/// What stands in the world, and what a car sees of it.
class World {
  public:
    World(const Track& track, const std::vector<Pose>& line, const RaceOptions& options)
        : options_(options),
          cones_(track.cones),
          random_(generator_of(
              fmt::format("{}/{}/{}/race", track.name, options.false_positive_rate, options.range_m),
              options.seed)) {
        for (Cone& cone : cones_) {
            cone.color = ConeColor::unknown;
            cone.confidence = 1.0;
        }
        if (options.condition.persistent) add_persistent(line);
        // Neither ids nor their order tell what a cone is.
        shuffle(cones_, random_);
        for (std::size_t i = 0; i < cones_.size(); ++i) cones_[i].id = static_cast<ConeId>(i);
    }

    [[nodiscard]] Frame look(const Pose& truth, double time_s) {
        const Condition& condition = options_.condition;
        Frame frame{time_s, truth, {}};
        boost::random::normal_distribution<double> normal;
        boost::random::uniform_01<double> uniform;
        const double to_left_m = condition.pose_noise_lateral_m * normal(random_);
        frame.pose.position += to_left_m * Point(-truth.heading().y(), truth.heading().x());
        frame.pose.yaw_rad += condition.pose_noise_yaw_rad * normal(random_);
        const HalfDisc view{frame.pose.position, frame.pose.heading(), options_.range_m};
        for (const Cone& cone : cones_) {
            if (!view.contains(cone.position)) continue;
            if (uniform(random_) < condition.miss_rate) continue;
            Cone seen = cone;
            const double x_m = condition.noise_sigma_m * normal(random_);
            const double y_m = condition.noise_sigma_m * normal(random_);
            seen.position += Point(x_m, y_m);
            frame.cones.push_back(seen);
        }
        if (!condition.persistent) add_fresh(frame, view);
        shuffle(frame.cones, random_);
        return frame;
    }

  private:
    [[nodiscard]] double false_to(double seen) const {
        const double rate = options_.false_positive_rate;
        return std::round(rate * seen / (1.0 - rate));
    }
    void add_persistent(const std::vector<Pose>& line) {
        std::vector<PersistentView> views;
        for (std::size_t i = 0; i < line.size(); i += 4) {
            PersistentView view{{line[i].position, line[i].heading(), options_.range_m}};
            const auto in_view = std::ranges::count_if(
                cones_, [&](const Cone& cone) { return view.view.contains(cone.position); });
            view.expected_points =
                false_to((1.0 - options_.condition.miss_rate) * static_cast<double>(in_view));
            views.push_back(view);
        }
        for (const Point& point : draw_persistent_points(views, random_)) {
            cones_.push_back({.id = 0, .position = point});
        }
    }
    void add_fresh(Frame& frame, const HalfDisc& view) {
        const auto count = static_cast<long>(false_to(static_cast<double>(frame.cones.size())));
        boost::random::uniform_real_distribution<double> any_m(-view.radius_m, view.radius_m);
        for (long i = 0; i < count;) {
            const double x_m = any_m(random_);
            const double y_m = any_m(random_);
            const Point point = view.centre + Point(x_m, y_m);
            if (!view.contains(point)) continue;
            frame.cones.push_back({.id = static_cast<ConeId>(cones_.size()) + next_id_++, .position = point});
            ++i;
        }
    }

    const RaceOptions& options_;
    std::vector<Cone> cones_;
    ConeId next_id_ = 0;
    Generator random_;
};

bool crosses(const std::vector<Point>& boundary, const Segment& way) {
    for (std::size_t i = 0; i < boundary.size(); ++i) {
        if (segments_intersect({boundary[i], boundary[(i + 1) % boundary.size()]}, way)) return true;
    }
    return false;
}

/// Whether a line moved by more than kUnsteady_m within kSteadyWithin_m of the car, as far as both go.
bool moved(const std::vector<Point>& before, const std::vector<Point>& now) {
    double along_m = 0.0;
    for (std::size_t i = 0; i < now.size(); ++i) {
        if (i > 0) along_m += (now[i] - now[i - 1]).norm();
        if (along_m > kSteadyWithin_m) break;
        const PolylineFoot foot = foot_on_polyline(now[i], before);
        const bool past_end = (foot.point - before.back()).norm() < 1e-6;
        const bool before_start = (foot.point - before.front()).norm() < 1e-6;
        if (!past_end && !before_start && foot.distance_m > kUnsteady_m) return true;
    }
    return false;
}

Point middle_of(const Pose& rear_axle) {
    return rear_axle.position + kMiddleAhead_m * rear_axle.heading();
}

}  // namespace

std::vector<Pose> true_line(const Track& track) {
    if (!track.closed) throw InvalidInput("tracks", "'" + track.name + "' is not closed");
    return centre_line_poses(boundaries(track), kLineStep_m);
}

Entrant truth_entrant(const Track& track) {
    return
        [line = positions(true_line(track)), at = std::optional<std::size_t>{}](const Frame& frame) mutable {
            const auto distance_m = [&](std::size_t i) {
                return (line[i % line.size()] - frame.pose.position).norm();
            };
            // After the first frame only a little ahead: another stretch of the course may be as near.
            const std::size_t first = at.value_or(0);
            const std::size_t count = at ? static_cast<std::size_t>(5.0 / kLineStep_m) : line.size();
            std::size_t nearest = first;
            for (std::size_t i = first; i < first + count; ++i) {
                if (distance_m(i) < distance_m(nearest)) nearest = i;
            }
            at = nearest % line.size();
            std::vector<Point> path;
            for (std::size_t i = 0; i <= static_cast<std::size_t>(kTruthAhead_m / kLineStep_m); ++i) {
                path.push_back(line[(*at + i) % line.size()]);
            }
            return std::optional(path);
        };
}

RaceResult race(const Track& track, const RaceOptions& options, const Entrant& entrant) {
    const std::vector<Pose> line = true_line(track);
    const std::vector<Point> centre = positions(line);
    const double length_m = polyline_length_m(centre, true);
    const TrackBoundaries lane = boundaries(track);
    World world(track, line, options);
    Vehicle car{line.front()};
    RaceResult result;
    struct Path {
        std::vector<Point> points;
        double frame_s;
        double arrives_s;
        double from_m = 0.0;
    };
    std::optional<Path> coming;
    std::optional<Path> driven;
    std::optional<std::vector<Point>> path_before;
    std::set<std::size_t> hit;
    std::vector<double> errors_m;
    int pairs = 0;
    int unsteady = 0;
    double last_frame_s = 0.0;
    double progress_m = 0.0;  // along the true line, laps included
    // Two and a half times the time that a perfect lap takes: who drives in circles does not finish.
    const double longest_s = 2.5 * options.laps * length_m / options.speed_mps + 10.0;
    for (int step = 0; step * kStep_s < longest_s; ++step) {
        const double time_s = step * kStep_s;
        if (step % kStepsPerFrame == 0) {
            last_frame_s = time_s;
            ++result.frames;
            std::optional<std::vector<Point>> answer = entrant(world.look(car.pose, time_s));
            if (answer && answer->size() < 2) answer.reset();
            if (!answer) ++result.frames_without_path;
            if (answer && path_before) {
                ++pairs;
                if (moved(*path_before, *answer)) ++unsteady;
            }
            path_before = answer;
            if (answer) coming = Path{std::move(*answer), time_s, time_s + options.latency_s};
        }
        if (coming && time_s >= coming->arrives_s - 1e-9) {
            driven = std::move(coming);
            coming.reset();
        }
        // A path of the frame before the last is the freshest while the last one is being answered.
        if (driven && driven->frame_s < last_frame_s - kStepsPerFrame * kStep_s - 1e-9) {
            result.old_path_s += kStep_s;
        }
        if (driven && time_s - driven->frame_s > kOldestPath_s + 1e-9) driven.reset();
        const double wanted_rad = driven ? pursue(car.pose, driven->points, lookahead_m(options.speed_mps),
                                                  driven->from_m)
                                         : 0.0;  // without a path straight on
        const Point before = middle_of(car.pose);
        car.drive(options.speed_mps, wanted_rad, kStep_s);
        const Point middle = middle_of(car.pose);
        result.driven_m += options.speed_mps * kStep_s;
        if (crosses(lane.left, {before, middle}) || crosses(lane.right, {before, middle})) {
            result.departure_m = result.driven_m;
            break;
        }
        for (std::size_t i = 0; i < track.cones.size(); ++i) {
            const Pose pose{middle, car.pose.yaw_rad};
            const Point& cone = track.cones[i].position;
            if (std::abs(pose.ahead_m(cone)) <= kHalfLength_m &&
                std::abs(pose.left_m(cone)) <= kHalfWidth_m) {
                hit.insert(i);
            }
        }
        const PolylineFoot foot = foot_on_polyline(middle, centre, true);
        errors_m.push_back(foot.distance_m);
        // The nearest lap count: progress is continuous within half a lap.
        const double ahead_m = std::remainder(foot.arc_length_m - progress_m, length_m);
        if (std::abs(ahead_m) < 5.0) progress_m += ahead_m;
        result.finished_laps = std::max(0, static_cast<int>(std::floor(progress_m / length_m)));
        if (result.finished_laps >= options.laps) {
            result.finished = true;
            break;
        }
    }
    result.cones_hit = static_cast<int>(hit.size());
    if (!errors_m.empty()) {
        const auto rank = static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(errors_m.size() - 1));
        std::ranges::nth_element(errors_m, errors_m.begin() + rank);
        result.lateral_error_p95_m = errors_m[static_cast<std::size_t>(rank)];
    }
    if (pairs > 0) result.unsteady_share = static_cast<double>(unsteady) / pairs;
    return result;
}

}  // namespace conelane::experiments
