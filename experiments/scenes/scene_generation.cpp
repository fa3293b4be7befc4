#include "experiments/scenes/scene_generation.hpp"

#include "experiments/scenes/ground_truth.hpp"
#include "experiments/seeded_random.hpp"
#include "experiments/tracks/centre_line.hpp"
#include "model/geometry.hpp"
#include "model/invalid_input.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>

#include <boost/random/beta_distribution.hpp>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_01.hpp>
#include <boost/random/uniform_int_distribution.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <fmt/format.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

namespace conelane::experiments {

struct Course {
    const Track& track;
    TrackBoundaries polylines;
    std::vector<Cone> cones;  ///< of the track, with the ids and colours that scenes show
    std::unordered_set<ConeId> boundary_ids;
};

namespace {

using Generator = boost::random::mt19937_64;

/// At most 99 false positives for a point seen; ids are drawn from a space with room for as many.
constexpr double kHighestRate = 0.99;
constexpr std::int64_t kSmallestIdSpace = 10'000;
constexpr std::int64_t kIdsPerCone = 128;
constexpr double kFarthest_m = 1e8;

/// A generator for one purpose, so that a draw for one does not move those for another: FNV-1a over the text,
/// then the finaliser of splitmix64.
Generator generator_for(std::string_view text) {
    std::uint64_t hash = 0xcbf29ce484222325U;
    for (const char c : text) {
        hash ^= static_cast<unsigned char>(c);
        hash *= 0x100000001b3U;
    }
    hash ^= hash >> 30U;
    hash *= 0xbf58476d1ce4e5b9U;
    hash ^= hash >> 27U;
    hash *= 0x94d049bb133111ebU;
    hash ^= hash >> 31U;
    return Generator(hash);
}

/// Drawn numbers are rounded: the last bits of sine, cosine and logarithm differ between C libraries.
double rounded(double value, double steps_per_unit) {
    return std::round(value * steps_per_unit) / steps_per_unit;
}
Point rounded(const Point& point) {
    return {rounded(point.x(), 1e6), rounded(point.y(), 1e6)};
}

/// The closed half disc ahead of a car.
struct HalfDisc {
    Point centre;
    Point heading;
    double radius_m;

    [[nodiscard]] bool contains(const Point& point) const {
        const Point offset = point - centre;
        return heading.dot(offset) >= 0.0 && offset.squaredNorm() <= radius_m * radius_m;
    }
};

std::int64_t id_space(const Track& track) {
    return std::max(kSmallestIdSpace, kIdsPerCone * static_cast<std::int64_t>(track.cones.size()));
}

ConeId draw_new_id(Generator& generator, std::int64_t space, std::unordered_set<ConeId>& used) {
    boost::random::uniform_int_distribution<ConeId> any(0, space - 1);
    ConeId id = any(generator);
    while (!used.insert(id).second) id = any(generator);
    return id;
}

Course make_course(const Track& track, const SceneOptions& options) {
    Course course{track, boundaries(track), track.cones, {}};
    Generator generator = generator_for(fmt::format("{}/{}/ids", track.name, options.seed));
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
                if (course.cones[index].color != ConeColor::orange) course.cones[index].color = color;
            }
        };
        paint(track.left, ConeColor::blue);
        paint(track.right, ConeColor::yellow);
    }
    return course;
}

enum class Sight { out_of_view, missed, seen };

/// A boundary's run in a scene, and whether nothing of the boundary is out of view.
struct Run {
    std::vector<ConeId> ids;
    bool whole = true;
};

/// The run of seen cones from the first one at or past the car's foot point on the boundary; it goes on past
/// missed cones and ends before the first one out of view.
Run run_ahead(const Course& course, const std::vector<std::size_t>& side, const std::vector<Point>& polyline,
              const std::vector<Sight>& sights, const Point& car) {
    const PolylineFoot foot = foot_on_polyline(car, polyline, course.track.closed);
    const bool at_vertex = (foot.point - polyline[foot.segment]).norm() <= kTieTolerance;
    // An open boundary of one cone has no next vertex; its only vertex is the foot.
    const std::size_t first = at_vertex ? foot.segment : foot.segment + 1;
    const std::size_t steps = course.track.closed ? side.size() : side.size() - first;
    Run run;
    for (std::size_t step = 0; step < steps; ++step) {
        const std::size_t cone = side[(first + step) % side.size()];
        if (sights[cone] == Sight::seen) {
            run.ids.push_back(course.cones[cone].id);
        } else if (sights[cone] == Sight::out_of_view && !run.ids.empty()) {
            break;
        }
    }
    run.whole =
        std::ranges::none_of(side, [&](std::size_t cone) { return sights[cone] == Sight::out_of_view; });
    return run;
}

std::string rate_text(double rate) {
    std::string text = fmt::format("{}", rate);
    if (text.find('e') != std::string::npos) return text;
    const std::size_t point = text.find('.');
    if (point == std::string::npos) return text + ".00";
    text.append(2 - std::min<std::size_t>(2, text.size() - point - 1), '0');
    return text;
}

/// One scene of a course: which pose, rate and range, and the steps from there to what the car sees.
class SceneMaker {
  public:
    SceneMaker(const Course& course, const SceneOptions& options, double rate, double range_m,
               std::size_t pose_index)
        : course_(course), options_(options), rate_(rate), range_m_(range_m), pose_index_(pose_index) {}

    /// Nothing where a run of the ground truth has fewer than two cones.
    [[nodiscard]] std::optional<AnnotatedScene> make(const Pose& on_course) const {
        AnnotatedScene result;
        result.track = course_.track.name;
        result.false_positive_rate = rate_;
        result.range_m = range_m_;
        result.seed = options_.seed;
        Scene& scene = result.scene;
        scene.id = id();
        scene.pose = disturbed(on_course);
        const HalfDisc view{scene.pose.position, scene.pose.heading(), range_m_};
        const std::vector<Sight> sights = look(view);
        scene.cones = seen_cones(sights);
        mistake_colors(scene.cones);
        Lane lane = ground_truth(sights, scene);
        if (lane.left.size() < 2 || lane.right.size() < 2) return std::nullopt;
        result.ground_truth = std::move(lane);
        add_false_positives(scene.cones, view);
        draw_confidences(scene.cones);
        Generator order = generator("order");
        shuffle(scene.cones, order);
        if (options_.nearest) {
            result.ground_truth = ground_truth_of_nearest(result, *options_.nearest);
            if (!result.ground_truth) return std::nullopt;
            scene = nearest_ahead(scene, *options_.nearest);
        }
        return result;
    }

  private:
    [[nodiscard]] Generator generator(std::string_view purpose) const {
        return generator_for(fmt::format("{}/{}/{}/{}/{}/{}", course_.track.name, pose_index_, rate_,
                                         range_m_, options_.seed, purpose));
    }

    [[nodiscard]] std::string id() const {
        std::string id = fmt::format("{}/pose_{:04}/fp_{}/range_{}", course_.track.name, pose_index_,
                                     rate_text(rate_), range_m_);
        if (options_.noise_sigma_m > 0.0) id += fmt::format("/noise_{}", options_.noise_sigma_m);
        if (options_.pose_noise_lateral_m > 0.0 || options_.pose_noise_yaw_rad > 0.0) {
            id +=
                fmt::format("/pose_noise_{}_{}", options_.pose_noise_lateral_m, options_.pose_noise_yaw_rad);
        }
        if (options_.miss_rate > 0.0) id += fmt::format("/miss_{}", options_.miss_rate);
        if (options_.color_error_rate > 0.0) id += fmt::format("/color_error_{}", options_.color_error_rate);
        if (options_.with_confidence) id += "/confidence";
        if (options_.nearest) id += fmt::format("/nearest_{}", *options_.nearest);
        return id;
    }

    [[nodiscard]] Pose disturbed(Pose pose) const {
        if (options_.pose_noise_lateral_m == 0.0 && options_.pose_noise_yaw_rad == 0.0) return pose;
        Generator random = generator("pose noise");
        boost::random::normal_distribution<double> standard;
        const double to_left_m = options_.pose_noise_lateral_m * standard(random);
        const Point heading = pose.heading();
        pose.position = rounded(pose.position + to_left_m * Point(-heading.y(), heading.x()));
        pose.yaw_rad = rounded(pose.yaw_rad + options_.pose_noise_yaw_rad * standard(random), 1e9);
        return pose;
    }

    /// What becomes of each map point.
    [[nodiscard]] std::vector<Sight> look(const HalfDisc& view) const {
        Generator random = generator("misses");
        boost::random::uniform_01<double> uniform;
        std::vector<Sight> sights(course_.cones.size(), Sight::out_of_view);
        for (std::size_t i = 0; i < sights.size(); ++i) {
            if (!view.contains(course_.cones[i].position)) continue;
            const bool missed = options_.miss_rate > 0.0 && uniform(random) < options_.miss_rate;
            sights[i] = missed ? Sight::missed : Sight::seen;
        }
        return sights;
    }

    [[nodiscard]] std::vector<Cone> seen_cones(const std::vector<Sight>& sights) const {
        Generator random = generator("position noise");
        boost::random::normal_distribution<double> standard;
        std::vector<Cone> cones;
        for (std::size_t i = 0; i < sights.size(); ++i) {
            if (sights[i] != Sight::seen) continue;
            cones.push_back(course_.cones[i]);
            if (options_.noise_sigma_m > 0.0) {
                const double x_m = options_.noise_sigma_m * standard(random);
                const double y_m = options_.noise_sigma_m * standard(random);
                cones.back().position = rounded(cones.back().position + Point(x_m, y_m));
            }
        }
        return cones;
    }

    void mistake_colors(std::vector<Cone>& cones) const {
        if (options_.color_error_rate == 0.0) return;
        Generator random = generator("color errors");
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

    void draw_confidences(std::vector<Cone>& cones) const {
        if (!options_.with_confidence) return;
        Generator random = generator("confidences");
        boost::random::beta_distribution<double> of_boundary(5.0, 2.0);
        boost::random::beta_distribution<double> of_others(2.0, 4.0);
        for (Cone& cone : cones) {
            const bool real = course_.boundary_ids.contains(cone.id);
            cone.confidence = rounded(real ? of_boundary(random) : of_others(random), 1e3);
        }
    }

    [[nodiscard]] Lane ground_truth(const std::vector<Sight>& sights, const Scene& scene) const {
        const Track& track = course_.track;
        Run left = run_ahead(course_, track.left, course_.polylines.left, sights, scene.pose.position);
        Run right = run_ahead(course_, track.right, course_.polylines.right, sights, scene.pose.position);
        Lane lane{std::move(left.ids), std::move(right.ids), track.closed && left.whole && right.whole};
        even_far_ends(lane, scene);
        return lane;
    }

    /// The number k solves k / (seen + k) = rate; positions are uniform in the half disc, by rejection.
    void add_false_positives(std::vector<Cone>& cones, const HalfDisc& view) const {
        const auto count = std::lround(rate_ * static_cast<double>(cones.size()) / (1.0 - rate_));
        Generator random = generator("false positives");
        boost::random::uniform_real_distribution<double> ahead_m(0.0, view.radius_m);
        boost::random::uniform_real_distribution<double> left_m(-view.radius_m, view.radius_m);
        boost::random::uniform_int_distribution<std::size_t> any_color(0, 2);
        constexpr std::array kColors{ConeColor::blue, ConeColor::yellow, ConeColor::unknown};
        const Point to_left(-view.heading.y(), view.heading.x());
        std::unordered_set<ConeId> used;
        for (const Cone& cone : course_.cones) used.insert(cone.id);
        for (long i = 0; i < count; ++i) {
            Cone cone;
            do {
                const double ahead = ahead_m(random);
                const double left = left_m(random);
                cone.position = rounded(view.centre + ahead * view.heading + left * to_left);
            } while (!view.contains(cone.position));
            cone.id = draw_new_id(random, id_space(course_.track), used);
            const ConeColor color = kColors[any_color(random)];
            if (options_.with_color) cone.color = color;
            cones.push_back(cone);
        }
    }

    const Course& course_;
    const SceneOptions& options_;
    double rate_;
    double range_m_;
    std::size_t pose_index_;
};

void require_between(double value, double lowest, double highest, const std::string& key) {
    if (!(value >= lowest && value <= highest)) {
        throw InvalidInput(key, fmt::format("must be in [{}, {}]", lowest, highest));
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

void require_near_origin(const Point& position, const std::string& key) {
    if (!(position.cwiseAbs().maxCoeff() <= kFarthest_m)) {
        throw InvalidInput(key, fmt::format("must be within {} m of the origin on each axis", kFarthest_m));
    }
}

}  // namespace

void validate(const SceneOptions& options) {
    constexpr double kLargest = 1000.0;
    require_list(options.false_positive_rates, 0.0, kHighestRate, "fp");
    require_list(options.ranges_m, 0.1, kLargest, "range");
    require_between(options.every_m, 0.01, kLargest, "every");
    if (options.nearest == 0U) throw InvalidInput("nearest", "must be at least 1");
    require_between(options.noise_sigma_m, 0.0, kLargest, "noise");
    require_between(options.pose_noise_lateral_m, 0.0, kLargest, "pose-noise");
    require_between(options.pose_noise_yaw_rad, 0.0, kLargest, "pose-noise");
    if (!(options.miss_rate >= 0.0 && options.miss_rate < 1.0)) {
        throw InvalidInput("miss", "must be in [0, 1)");
    }
    require_between(options.color_error_rate, 0.0, 1.0, "color-error");
    if (options.color_error_rate > 0.0 && !options.with_color) {
        throw InvalidInput("color-error", "needs scenes with colour");
    }
    if (options.threads < 1 || options.threads > 1024) {
        throw InvalidInput("threads", "must be in [1, 1024]");
    }
}

TrackLaps::TrackLaps(const Track& track, std::span<const Pose> poses, const SceneOptions& options)
    : poses_(poses), options_(options) {
    validate(options);
    for (std::size_t i = 0; i < track.cones.size(); ++i) {
        require_near_origin(track.cones[i].position, fmt::format("{}: cones[{}]", track.name, i));
    }
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const std::string key = fmt::format("{}: poses[{}]", track.name, i);
        require_near_origin(poses[i].position, key);
        if (!std::isfinite(poses[i].yaw_rad)) throw InvalidInput(key, "yaw must be a finite number");
    }
    if (track.left.size() < 2 || track.right.size() < 2) return;
    course_ = std::make_unique<const Course>(make_course(track, options));
}

TrackLaps::~TrackLaps() = default;

std::size_t TrackLaps::size() const {
    return options_.ranges_m.size() * options_.false_positive_rates.size();
}

std::optional<AnnotatedScene> TrackLaps::scene(std::size_t lap, std::size_t pose) const {
    const std::size_t rates = options_.false_positive_rates.size();
    const double rate = options_.false_positive_rates[lap % rates] + 0.0;  // -0 counts as 0
    return SceneMaker(*course_, options_, rate, options_.ranges_m[lap / rates], pose).make(poses_[pose]);
}

std::vector<AnnotatedScene> TrackLaps::make(std::size_t lap) const {
    if (!course_) return {};
    std::vector<std::optional<AnnotatedScene>> made(poses_.size());
    oneapi::tbb::task_arena arena(
        std::min(static_cast<int>(options_.threads), oneapi::tbb::info::default_concurrency()));
    arena.execute([&] {
        oneapi::tbb::parallel_for(std::size_t{0}, made.size(),
                                  [&](std::size_t pose) { made[pose] = scene(lap, pose); });
    });
    std::vector<AnnotatedScene> scenes;
    for (std::optional<AnnotatedScene>& seen : made) {
        if (seen) scenes.push_back(*std::move(seen));
    }
    return scenes;
}

bool TrackLaps::is_empty(std::size_t lap) const {
    if (!course_) return true;
    for (std::size_t pose = 0; pose < poses_.size(); ++pose) {
        if (scene(lap, pose)) return false;
    }
    return true;
}

std::vector<AnnotatedScene> generate_scenes(const Track& track, std::span<const Pose> poses,
                                            const SceneOptions& options) {
    const TrackLaps laps(track, poses, options);
    std::vector<AnnotatedScene> scenes;
    for (std::size_t lap = 0; lap < laps.size(); ++lap) {
        std::ranges::move(laps.make(lap), std::back_inserter(scenes));
    }
    return scenes;
}

std::vector<AnnotatedScene> generate_scenes(const Track& track, const SceneOptions& options) {
    validate(options);
    return generate_scenes(track, centre_line_poses(boundaries(track), options.every_m), options);
}

}  // namespace conelane::experiments
