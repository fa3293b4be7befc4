#include "evaluation/world/scene_generation.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/world/course.hpp"
#include "evaluation/world/false_positives.hpp"
#include "evaluation/world/scene_maker.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <future>
#include <iterator>
#include <string>
#include <thread>
#include <utility>

#include <fmt/format.h>

namespace conelane {
namespace {

constexpr double kMaxCoordinate_m = 1e8;
/// Travel between the poses whose views decide where persistent false positives are.
constexpr double kLapStep_m = 1.1;

void require_near_origin(const Point& position, const std::string& key) {
    if (!(position.cwiseAbs().maxCoeff() <= kMaxCoordinate_m)) {
        throw InvalidInput(key,
                           fmt::format("must be within {} m of the origin on each axis", kMaxCoordinate_m));
    }
}

std::vector<Viewpoint> viewpoints_asked_for(const Track& track, const SceneOptions& options) {
    validate(options);
    return viewpoints_along(track, options.every_m);
}

}  // namespace

TrackLaps::TrackLaps(const Track& track, std::span<const Pose> poses, const SceneOptions& options)
    : TrackLaps(track, viewpoints_at(poses), options) {}

TrackLaps::TrackLaps(const Track& track, const SceneOptions& options)
    : TrackLaps(track, viewpoints_asked_for(track, options), options) {}

TrackLaps::TrackLaps(const Track& track, std::vector<Viewpoint> viewpoints, const SceneOptions& options)
    : viewpoints_(std::move(viewpoints)), options_(options) {
    validate(options);
    conditions_ = conditions_of(options);
    for (std::size_t i = 0; i < track.cones.size(); ++i) {
        require_near_origin(track.cones[i].position, fmt::format("{}: cones[{}]", track.name, i));
    }
    for (std::size_t i = 0; i < viewpoints_.size(); ++i) {
        const Pose& pose = viewpoints_[i].pose;
        const std::string key = fmt::format("{}: poses[{}]", track.name, i);
        require_near_origin(pose.position, key);
        if (!std::isfinite(pose.yaw_rad)) throw InvalidInput(key, "yaw must be a finite number");
    }
    if (track.driven.empty() && (track.left.size() < 2 || track.right.size() < 2)) return;
    Course course = make_course(track, options);
    if (std::ranges::any_of(conditions_, &Condition::persistent)) {
        course.lap = viewpoints_along(track, kLapStep_m);
    }
    course_ = std::make_unique<const Course>(std::move(course));
}

TrackLaps::~TrackLaps() = default;

std::size_t TrackLaps::size() const {
    return conditions_.size() * options_.ranges_m.size() * options_.false_positive_rates.size();
}

namespace {

Lap lap_of(const Course& course, const SceneOptions& options, const std::vector<Condition>& conditions,
           std::size_t lap) {
    const std::size_t rates = options.false_positive_rates.size();
    const std::size_t ranges = options.ranges_m.size();
    const double rate = options.false_positive_rates[lap % rates] + 0.0;  // turns -0 into 0
    const double range_m = options.ranges_m[lap / rates % ranges];
    const Condition& condition = conditions[lap / rates / ranges];
    return {condition, rate, range_m, persistent_false_positives(course, options, condition, rate, range_m)};
}

}  // namespace

std::vector<AnnotatedScene> TrackLaps::make(std::size_t lap) const {
    if (!course_) return {};
    const Lap shared = lap_of(*course_, options_, conditions_, lap);
    std::vector<std::optional<AnnotatedScene>> made(viewpoints_.size());
    std::atomic<std::size_t> next = 0;
    const auto work = [&] {
        for (std::size_t pose = next++; pose < made.size(); pose = next++) {
            made[pose] = make_scene(*course_, options_, shared, viewpoints_[pose], pose);
        }
    };
    std::vector<std::future<void>> others(
        std::max(1U, std::min(options_.threads, std::thread::hardware_concurrency())) - 1U);
    for (std::future<void>& other : others) other = std::async(std::launch::async, work);
    work();
    for (std::future<void>& other : others) other.get();
    std::vector<AnnotatedScene> scenes;
    for (std::optional<AnnotatedScene>& seen : made) {
        if (seen) scenes.push_back(*std::move(seen));
    }
    return scenes;
}

bool TrackLaps::is_empty(std::size_t lap) const {
    if (!course_) return true;
    const Lap shared = lap_of(*course_, options_, conditions_, lap);
    for (std::size_t pose = 0; pose < viewpoints_.size(); ++pose) {
        const auto scene = make_scene(*course_, options_, shared, viewpoints_[pose], pose);
        if (scene && (scene->ground_truth || !course_->track.driven.empty())) return false;
    }
    return true;
}

namespace {

std::vector<AnnotatedScene> all_scenes(const Track& track, const TrackLaps& laps) {
    std::vector<AnnotatedScene> scenes;
    for (std::size_t lap = 0; lap < laps.size(); ++lap) {
        std::ranges::move(laps.make(lap), std::back_inserter(scenes));
    }
    if (track.driven.empty())
        std::erase_if(scenes, [](const AnnotatedScene& scene) { return !scene.ground_truth; });
    return scenes;
}

}  // namespace

std::vector<AnnotatedScene> generate_scenes(const Track& track, std::span<const Pose> poses,
                                            const SceneOptions& options) {
    return all_scenes(track, TrackLaps(track, poses, options));
}

std::vector<AnnotatedScene> generate_scenes(const Track& track, const SceneOptions& options) {
    return all_scenes(track, TrackLaps(track, options));
}

}  // namespace conelane
