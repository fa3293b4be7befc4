#include "evaluation/world/scene_generation.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/seeded_random.hpp"
#include "evaluation/world/course.hpp"

#include <array>
#include <atomic>
#include <future>
#include <iterator>
#include <numbers>
#include <thread>

#include <boost/random/beta_distribution.hpp>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_01.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace conelane {
namespace {

/// At most 99 false positives for each seen point; the ids are drawn from a space of that size.
constexpr double kMaxRate = 0.99;

void require_between(double value, double lowest, double highest, const std::string& key) {
    if (!(value >= lowest && value <= highest)) {
        const char* const note = key == "fp" && value > 1.0 ? ": a share; 30 % is 0.3" : "";
        throw InvalidInput(key, fmt::format("must be in [{}, {}]{}", lowest, highest, note));
    }
}

void require_list(const std::vector<double>& values, double lowest, double highest, const std::string& key) {
    if (values.empty()) throw InvalidInput(key, "must hold at least one value");
    for (const double value : values) {
        require_between(value, lowest, highest, key);
        if (std::ranges::count(values, value) > 1) {
            throw InvalidInput(key, fmt::format("{} is there twice", value));
        }
    }
}

/// The condition with the changes of the options.
Condition adapted(Condition condition, const SceneOptions& options) {
    const Condition own = condition;
    condition.noise_sigma_m = options.noise_sigma_m.value_or(own.noise_sigma_m);
    condition.noise_by_range = options.noise_by_range.value_or(own.noise_by_range);
    condition.pose_noise_lateral_m = options.pose_noise_lateral_m.value_or(own.pose_noise_lateral_m);
    condition.pose_noise_yaw_rad = options.pose_noise_yaw_rad.value_or(own.pose_noise_yaw_rad);
    condition.miss_rate = options.miss_rate.value_or(own.miss_rate);
    condition.persistent = options.persistent.value_or(own.persistent);
    if (own.name.empty()) return condition;
    if (condition.noise_sigma_m != own.noise_sigma_m) condition.name += "+" + noise_text(condition);
    if (condition.noise_by_range != own.noise_by_range)
        condition.name += "+" + noise_by_range_text(condition);
    if (condition.pose_noise_lateral_m != own.pose_noise_lateral_m ||
        condition.pose_noise_yaw_rad != own.pose_noise_yaw_rad) {
        condition.name += "+" + pose_noise_text(condition);
    }
    if (condition.miss_rate != own.miss_rate) condition.name += "+" + miss_text(condition);
    if (condition.persistent != own.persistent) {
        condition.name += condition.persistent ? "+persist" : "+no_persist";
    }
    return condition;
}

/// Data that the scenes of one lap share.
struct Lap {
    Condition condition;
    double rate;
    double range_m;
    std::vector<Cone> persistent;  ///< false positives in the world
};

/// The condition that adds nothing to the id of a scene.
constexpr std::string_view kUndisturbed = "paper";

std::string rate_text(double rate) {
    std::string text = fmt::format("{}", rate);
    if (text.find('e') != std::string::npos) return text;
    const std::size_t point = text.find('.');
    if (point == std::string::npos) return text + ".00";
    text.append(2 - std::min<std::size_t>(2, text.size() - point - 1), '0');
    return text;
}

/// One scene of a lap: the steps from its pose to the cones that the car sees.
class SceneMaker {
  public:
    SceneMaker(const Course& course, const SceneOptions& options, const Lap& lap, const Viewpoint& viewpoint,
               std::size_t pose_index)
        : course_(course),
          options_(options),
          lap_(lap),
          viewpoint_(viewpoint),
          pose_index_(pose_index),
          places_(places_of(course, viewpoint)) {}

    /// Nothing if a run of the ground truth has fewer than two cones, or no cone is seen. A degenerate ground
    /// truth is left out of its scene.
    [[nodiscard]] std::optional<AnnotatedScene> make() const {
        AnnotatedScene result;
        result.track = course_.track.name;
        result.false_positive_rate = lap_.rate;
        result.range_m = lap_.range_m;
        result.seed = options_.seed;
        result.condition = lap_.condition.name;
        Scene& scene = result.scene;
        scene.id = id();
        scene.pose = disturbed(viewpoint_.pose);
        const HalfDisc view{scene.pose.position, scene.pose.heading(), lap_.range_m};
        const std::vector<Sight> sights = look(view);
        const RunFrame* const frame = viewpoint_.frame;
        if (frame != nullptr) result.travelled_m = rounded(frame->travelled_m, 1e6);
        if (frame != nullptr || !lap_.condition.name.empty() || lap_.condition.persistent) {
            result.missed = missed_cones(sights);
        }
        scene.cones = seen_cones(sights, scene.pose.position);
        mistake_colors(scene.cones);
        hide_colors(scene.cones);
        if (course_.track.driven.empty()) {
            Lane lane = ground_truth(sights, scene);
            if (lane.left.size() < 2 || lane.right.size() < 2) return std::nullopt;
            result.ground_truth = std::move(lane);
        } else if (scene.cones.empty()) {
            return std::nullopt;
        }
        add_false_positives(scene.cones, view);
        state_covariances(scene);
        draw_confidences(scene.cones);
        SceneGenerator order = generator("order");
        shuffle(scene.cones, order);
        if (options_.nearest) {
            const bool known = result.ground_truth.has_value();
            result.ground_truth = ground_truth_of_nearest(result, *options_.nearest);
            if (known && !result.ground_truth) return std::nullopt;
            scene = nearest_ahead(scene, *options_.nearest);
        }
        if (result.ground_truth && is_degenerate(*result.ground_truth, scene)) result.ground_truth.reset();
        return result;
    }

  private:
    [[nodiscard]] SceneGenerator generator(std::string_view purpose) const {
        return generator_for(fmt::format("{}/{}/{}/{}/{}/{}", course_.track.name, pose_index_, lap_.rate,
                                         lap_.range_m, options_.seed, purpose));
    }

    [[nodiscard]] std::string id() const {
        std::string id = fmt::format("{}/pose_{:04}/fp_{}/range_{}", course_.track.name, pose_index_,
                                     rate_text(lap_.rate), lap_.range_m);
        const Condition& condition = lap_.condition;
        if (condition.name.empty()) {
            for (const std::string& part : disturbances(condition)) id += "/" + part;
        } else if (condition.name != kUndisturbed) {
            id += "/" + condition.name;
        }
        if (options_.color_error_rate > 0.0) id += fmt::format("/color_error_{}", options_.color_error_rate);
        if (options_.color_unknown_rate > 0.0)
            id += fmt::format("/color_unknown_{}", options_.color_unknown_rate);
        if (options_.with_confidence) id += "/confidence";
        if (options_.nearest) id += fmt::format("/nearest_{}", *options_.nearest);
        return id;
    }

    [[nodiscard]] Pose disturbed(Pose pose) const {
        const Condition& condition = lap_.condition;
        if (condition.pose_noise_lateral_m == 0.0 && condition.pose_noise_yaw_rad == 0.0) return pose;
        SceneGenerator random = generator("pose noise");
        boost::random::normal_distribution<double> standard;
        const double to_left_m = condition.pose_noise_lateral_m * standard(random);
        const Point heading = pose.heading();
        pose.position = rounded(pose.position + to_left_m * Point(-heading.y(), heading.x()));
        pose.yaw_rad = rounded(pose.yaw_rad + condition.pose_noise_yaw_rad * standard(random), 1e9);
        return pose;
    }

    /// Decides for each map point whether, where and how it is seen.
    [[nodiscard]] std::vector<Sight> look(const HalfDisc& view) const {
        SceneGenerator random = generator("misses");
        boost::random::uniform_01<double> uniform;
        std::vector<Sight> sights(course_.cones.size(), Sight::out_of_view);
        for (std::size_t i = 0; i < sights.size(); ++i) {
            if (!view.contains(places_[i].value_or(course_.cones[i].position))) continue;
            if (!places_[i]) {
                sights[i] = Sight::unmapped;
                continue;
            }
            const double miss_rate = lap_.condition.miss_rate;
            const bool missed = miss_rate > 0.0 && uniform(random) < miss_rate;
            sights[i] = missed ? Sight::missed : Sight::seen;
        }
        return sights;
    }

    [[nodiscard]] std::vector<Cone> missed_cones(const std::vector<Sight>& sights) const {
        std::vector<Cone> cones;
        for (std::size_t i = 0; i < sights.size(); ++i) {
            if (sights[i] != Sight::missed && sights[i] != Sight::unmapped) continue;
            cones.push_back(course_.cones[i]);
            cones.back().position = places_[i].value_or(course_.cones[i].position);
        }
        return cones;
    }

    [[nodiscard]] std::vector<Cone> seen_cones(const std::vector<Sight>& sights, const Point& car) const {
        SceneGenerator random = generator("position noise");
        boost::random::normal_distribution<double> standard;
        std::vector<Cone> cones;
        for (std::size_t i = 0; i < sights.size(); ++i) {
            if (sights[i] != Sight::seen) continue;
            cones.push_back(course_.cones[i]);
            cones.back().position = *places_[i];
            const double distance_m = (cones.back().position - car).norm();
            if (const double sigma_m = lap_.condition.noise_m(distance_m); sigma_m > 0.0) {
                const double x_m = sigma_m * standard(random);
                const double y_m = sigma_m * standard(random);
                cones.back().position = rounded(cones.back().position + Point(x_m, y_m));
            }
        }
        return cones;
    }

    /// By where a cone was seen, as a sensor states it: false positives have covariances of the same kind.
    void state_covariances(Scene& scene) const {
        if (lap_.condition.noise_by_range == 0.0) return;
        for (Cone& cone : scene.cones) {
            const double sigma_m = lap_.condition.noise_m((cone.position - scene.pose.position).norm());
            const double variance_m2 = rounded(sigma_m * sigma_m, 1e6);
            cone.position_covariance = PositionCovariance{variance_m2, 0.0, variance_m2};
        }
    }

    void mistake_colors(std::vector<Cone>& cones) const {
        if (options_.color_error_rate == 0.0) return;
        SceneGenerator random = generator("color errors");
        boost::random::uniform_01<double> uniform;
        for (Cone& cone : cones) {
            if (uniform(random) >= options_.color_error_rate) continue;
            if (cone.color == ConeColor::blue) {
                cone.color = ConeColor::yellow;
            } else if (cone.color == ConeColor::yellow) {
                cone.color = ConeColor::blue;
            }
        }
    }

    void hide_colors(std::vector<Cone>& cones) const {
        if (options_.color_unknown_rate == 0.0) return;
        SceneGenerator random = generator("unknown colors");
        boost::random::uniform_01<double> uniform;
        for (Cone& cone : cones) {
            if (uniform(random) < options_.color_unknown_rate) cone.color = ConeColor::unknown;
        }
    }

    void draw_confidences(std::vector<Cone>& cones) const {
        if (!options_.with_confidence) return;
        SceneGenerator random = generator("confidences");
        boost::random::beta_distribution<double> of_boundary(5.0, 2.0);
        boost::random::beta_distribution<double> of_others(2.0, 4.0);
        for (Cone& cone : cones) {
            const bool real = course_.boundary_ids.contains(cone.id);
            cone.confidence = rounded(real ? of_boundary(random) : of_others(random), 1e3);
        }
    }

    [[nodiscard]] Lane ground_truth(const std::vector<Sight>& sights, const Scene& scene) const {
        Lane lane = seen_lane(course_, sights, scene.pose.position);
        even_far_ends(lane, scene);
        return lane;
    }

    void add_false_positives(std::vector<Cone>& cones, const HalfDisc& view) const {
        if (lap_.condition.persistent) {
            std::ranges::copy_if(lap_.persistent, std::back_inserter(cones),
                                 [&](const Cone& cone) { return view.contains(cone.position); });
        } else {
            add_fresh_false_positives(cones, view);
        }
    }

    /// Uniform in the half disc, by rejection.
    void add_fresh_false_positives(std::vector<Cone>& cones, const HalfDisc& view) const {
        const long count = false_positives_to(static_cast<double>(cones.size()), lap_.rate);
        SceneGenerator random = generator("false positives");
        boost::random::uniform_real_distribution<double> ahead_m(0.0, view.radius_m);
        boost::random::uniform_real_distribution<double> left_m(-view.radius_m, view.radius_m);
        const Point to_left(-view.heading.y(), view.heading.x());
        FalsePositives false_positives(course_, options_.with_color);
        for (long i = 0; i < count; ++i) {
            Point position;
            do {
                const double ahead = ahead_m(random);
                const double left = left_m(random);
                position = rounded(view.centre + ahead * view.heading + left * to_left);
            } while (!view.contains(position));
            cones.push_back(false_positives.draw(position, random));
        }
    }

    const Course& course_;
    const SceneOptions& options_;
    const Lap& lap_;
    const Viewpoint& viewpoint_;
    std::size_t pose_index_;
    std::vector<std::optional<Point>> places_;  ///< of the course's cones on the map
};

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

Lap lap_of(const Course& course, const SceneOptions& options, const std::vector<Condition>& conditions,
           std::size_t lap) {
    const std::size_t rates = options.false_positive_rates.size();
    const std::size_t ranges = options.ranges_m.size();
    const double rate = options.false_positive_rates[lap % rates] + 0.0;  // turns -0 into 0
    const double range_m = options.ranges_m[lap / rates % ranges];
    const Condition& condition = conditions[lap / rates / ranges];
    return {condition, rate, range_m, persistent_false_positives(course, options, condition, rate, range_m)};
}

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

std::span<const Condition> named_conditions() {
    constexpr double kDegree_rad = std::numbers::pi / 180.0;
    // Noise [m], pose noise [m] and [rad], misses; whether false positives persist.
    static const std::array<Condition, 4> conditions{{{"paper"},
                                                      {"car", 0.1, 0.3, 5.0 * kDegree_rad, 0.05, true},
                                                      {"harsh", 0.2, 0.5, 8.0 * kDegree_rad, 0.1, true},
                                                      {"slam", 0.1, 0.1, 1.0 * kDegree_rad, 0.05, true}}};
    return conditions;
}

double Condition::noise_m(double distance_m) const {
    return noise_by_range > 0.0 ? std::hypot(noise_sigma_m, noise_by_range * distance_m) : noise_sigma_m;
}

std::string noise_text(const Condition& condition) {
    return fmt::format("noise_{}", condition.noise_sigma_m);
}
std::string pose_noise_text(const Condition& condition) {
    return fmt::format("pose_noise_{}_{}", condition.pose_noise_lateral_m, condition.pose_noise_yaw_rad);
}
std::string miss_text(const Condition& condition) {
    return fmt::format("miss_{}", condition.miss_rate);
}
std::string noise_by_range_text(const Condition& condition) {
    return fmt::format("noise_by_range_{}", condition.noise_by_range);
}

std::vector<std::string> disturbances(const Condition& condition) {
    std::vector<std::string> parts;
    if (condition.noise_sigma_m > 0.0) parts.push_back(noise_text(condition));
    if (condition.noise_by_range > 0.0) parts.push_back(noise_by_range_text(condition));
    if (condition.pose_noise_lateral_m > 0.0 || condition.pose_noise_yaw_rad > 0.0) {
        parts.push_back(pose_noise_text(condition));
    }
    if (condition.miss_rate > 0.0) parts.push_back(miss_text(condition));
    if (condition.persistent) parts.emplace_back("persist");
    return parts;
}

void validate(const SceneOptions& options) {
    constexpr double kMax = 1000.0;
    require_list(options.false_positive_rates, 0.0, kMaxRate, "fp");
    require_list(options.ranges_m, 0.1, kMax, "range");
    require_between(options.every_m, 0.01, kMax, "every");
    if (options.nearest == 0U) throw InvalidInput("nearest", "must be at least 1");
    static_cast<void>(conditions_of(options));
    require_between(options.noise_sigma_m.value_or(0.0), 0.0, kMax, "noise");
    require_between(options.noise_by_range.value_or(0.0), 0.0, 1.0, "noise-by-range");
    require_between(options.pose_noise_lateral_m.value_or(0.0), 0.0, kMax, "pose-noise");
    require_between(options.pose_noise_yaw_rad.value_or(0.0), 0.0, kMax, "pose-noise");
    const double miss_rate = options.miss_rate.value_or(0.0);
    if (!(miss_rate >= 0.0 && miss_rate < 1.0)) {
        throw InvalidInput("miss", "must be in [0, 1)");
    }
    for (const auto& [rate, key] : {std::pair{options.color_error_rate, "color-wrong"},
                                    {options.color_unknown_rate, "color-unknown"}}) {
        require_between(rate, 0.0, 1.0, key);
        if (rate > 0.0 && !options.with_color) throw InvalidInput(key, "needs scenes with colour");
    }
    if (options.threads < 1 || options.threads > 1024) {
        throw InvalidInput("threads", "must be in [1, 1024]");
    }
}

std::vector<Condition> conditions_of(const SceneOptions& options) {
    if (options.conditions.empty()) return {adapted(Condition{}, options)};
    std::vector<Condition> conditions;
    for (const std::string& name : options.conditions) {
        const auto known = std::ranges::find(named_conditions(), name, &Condition::name);
        if (known == named_conditions().end()) {
            std::vector<std::string> names;
            for (const Condition& condition : named_conditions()) names.push_back(condition.name);
            throw InvalidInput("condition",
                               fmt::format("'{}' is not one of {}", name, fmt::join(names, ", ")));
        }
        if (std::ranges::count(options.conditions, name) > 1) {
            throw InvalidInput("condition", fmt::format("{} is there twice", name));
        }
        conditions.push_back(adapted(*known, options));
    }
    return conditions;
}

std::vector<std::string> condition_names(const SceneOptions& options) {
    std::vector<std::string> names;
    if (options.conditions.empty()) return names;
    for (const Condition& condition : conditions_of(options)) names.push_back(condition.name);
    return names;
}

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

std::vector<AnnotatedScene> TrackLaps::make(std::size_t lap) const {
    if (!course_) return {};
    const Lap shared = lap_of(*course_, options_, conditions_, lap);
    std::vector<std::optional<AnnotatedScene>> made(viewpoints_.size());
    std::atomic<std::size_t> next = 0;
    const auto work = [&] {
        for (std::size_t pose = next++; pose < made.size(); pose = next++) {
            made[pose] = SceneMaker(*course_, options_, shared, viewpoints_[pose], pose).make();
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
        const auto scene = SceneMaker(*course_, options_, shared, viewpoints_[pose], pose).make();
        if (scene && (scene->ground_truth || !course_->track.driven.empty())) return false;
    }
    return true;
}

std::vector<AnnotatedScene> generate_scenes(const Track& track, std::span<const Pose> poses,
                                            const SceneOptions& options) {
    return all_scenes(track, TrackLaps(track, poses, options));
}

std::vector<AnnotatedScene> generate_scenes(const Track& track, const SceneOptions& options) {
    return all_scenes(track, TrackLaps(track, options));
}

}  // namespace conelane
