#include "evaluation/scenes/scene_generation.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/scenes/degenerate_truth.hpp"
#include "evaluation/scenes/ground_truth.hpp"
#include "evaluation/scenes/half_disc.hpp"
#include "evaluation/scenes/persistent_points.hpp"
#include "evaluation/seeded_random.hpp"
#include "evaluation/tracks/centre_line.hpp"
#include "model/geometry.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <future>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <unordered_set>
#include <utility>

#include <boost/random/beta_distribution.hpp>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_01.hpp>
#include <boost/random/uniform_int_distribution.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace conelane {

struct Course {
    const Track& track;
    TrackBoundaries polylines;
    std::vector<Cone> cones;  ///< of the track, with the ids and colors that scenes show
    std::unordered_set<ConeId> boundary_ids;
    std::vector<Viewpoint> lap;  ///< along the whole course; empty where no false positives persist
};

namespace {

using Generator = boost::random::mt19937_64;

/// At most 99 false positives for a point seen; ids are drawn from a space with room for as many.
constexpr double kMaxRate = 0.99;
constexpr std::int64_t kMinIdSpace = 10'000;
constexpr std::int64_t kIdsPerCone = 128;
constexpr double kMaxCoordinate_m = 1e8;
/// Travel between the poses whose views decide where false positives persist.
constexpr double kLapStep_m = 1.1;

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

std::int64_t id_space(const Track& track) {
    return std::max(kMinIdSpace, kIdsPerCone * static_cast<std::int64_t>(track.cones.size()));
}

ConeId draw_new_id(Generator& generator, std::int64_t space, std::unordered_set<ConeId>& used) {
    boost::random::uniform_int_distribution<ConeId> any(0, space - 1);
    ConeId id = any(generator);
    while (!used.insert(id).second) id = any(generator);
    return id;
}

Course make_course(const Track& track, const SceneOptions& options) {
    Course course{track, boundaries(track), track.cones, {}, {}};
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

enum class Sight { out_of_view, unmapped, missed, seen };

/// A boundary's run in a scene, and whether nothing of the boundary is out of view.
struct Run {
    std::vector<ConeId> ids;
    bool whole = true;
};

/// The run of seen cones from the first one at or past the car's foot point on the boundary; it goes on past
/// missed cones and single ones that the map lacks, and ends before the first one out of view.
Run run_ahead(const Course& course, const std::vector<std::size_t>& side, const std::vector<Point>& polyline,
              const std::vector<Sight>& sights, const Point& car) {
    const PolylineFoot foot = foot_on_polyline(car, polyline, course.track.closed);
    const bool at_vertex = (foot.point - polyline[foot.segment]).norm() <= kTieTolerance;
    // An open boundary of one cone has no next vertex; its only vertex is the foot.
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

std::string noise_text(const Condition& condition) {
    return fmt::format("noise_{}", condition.noise_sigma_m);
}
std::string pose_noise_text(const Condition& condition) {
    return fmt::format("pose_noise_{}_{}", condition.pose_noise_lateral_m, condition.pose_noise_yaw_rad);
}
std::string miss_text(const Condition& condition) {
    return fmt::format("miss_{}", condition.miss_rate);
}

/// The condition that needs no part of its own in the id of a scene.
constexpr std::string_view kUndisturbed = "paper";

/// What of a condition ids name, in their order.
std::vector<std::string> disturbances(const Condition& condition) {
    std::vector<std::string> parts;
    if (condition.noise_sigma_m > 0.0) parts.push_back(noise_text(condition));
    if (condition.pose_noise_lateral_m > 0.0 || condition.pose_noise_yaw_rad > 0.0) {
        parts.push_back(pose_noise_text(condition));
    }
    if (condition.miss_rate > 0.0) parts.push_back(miss_text(condition));
    if (condition.persistent) parts.emplace_back("persist");
    return parts;
}

std::string rate_text(double rate) {
    std::string text = fmt::format("{}", rate);
    if (text.find('e') != std::string::npos) return text;
    const std::size_t point = text.find('.');
    if (point == std::string::npos) return text + ".00";
    text.append(2 - std::min<std::size_t>(2, text.size() - point - 1), '0');
    return text;
}

constexpr std::array kFalseColors{ConeColor::blue, ConeColor::yellow, ConeColor::unknown};

/// Draws id and, with colors, color of false positives of a course.
class FalsePositives {
  public:
    FalsePositives(const Course& course, bool with_color)
        : space_(id_space(course.track)), with_color_(with_color) {
        for (const Cone& cone : course.cones) used_.insert(cone.id);
    }

    [[nodiscard]] Cone draw(const Point& position, Generator& random) {
        Cone cone;
        cone.position = position;
        cone.id = draw_new_id(random, space_, used_);
        const ConeColor color = kFalseColors[any_color_(random)];
        if (with_color_) cone.color = color;
        return cone;
    }

  private:
    std::int64_t space_;
    bool with_color_;
    std::unordered_set<ConeId> used_;
    boost::random::uniform_int_distribution<std::size_t> any_color_{0, kFalseColors.size() - 1};
};

/// Where the map of a viewpoint has each cone of the course, nothing where it lacks it.
std::vector<std::optional<Point>> places_of(const Course& course, const Viewpoint& viewpoint) {
    std::vector<std::optional<Point>> places(course.cones.size());
    if (viewpoint.frame != nullptr) {
        for (const MapPlace& place : viewpoint.frame->map) places[place.cone] = place.position;
    } else {
        std::ranges::transform(course.cones, places.begin(), &Cone::position);
    }
    return places;
}

/// What the scenes of one lap share.
struct Lap {
    Condition condition;
    double rate;
    double range_m;
    std::vector<Cone> persistent;  ///< false positives in the world
};

/// How many false positives there are to so many points seen: k / (seen + k) = rate.
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
    Generator random = generator_for(fmt::format("{}/{}/{}/{}/persistent false positives", course.track.name,
                                                 rate, range_m, options.seed));
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

/// One scene of a lap, and the steps from its pose to what the car sees.
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

    /// Nothing where a run of the ground truth has fewer than two cones, or no cone is seen. A degenerate
    /// ground truth is left out of its scene.
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
        scene.cones = seen_cones(sights);
        mistake_colors(scene.cones);
        if (course_.track.driven.empty()) {
            Lane lane = ground_truth(sights, scene);
            if (lane.left.size() < 2 || lane.right.size() < 2) return std::nullopt;
            result.ground_truth = std::move(lane);
        } else if (scene.cones.empty()) {
            return std::nullopt;
        }
        add_false_positives(scene.cones, view);
        draw_confidences(scene.cones);
        Generator order = generator("order");
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
    [[nodiscard]] Generator generator(std::string_view purpose) const {
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
        if (options_.with_confidence) id += "/confidence";
        if (options_.nearest) id += fmt::format("/nearest_{}", *options_.nearest);
        return id;
    }

    [[nodiscard]] Pose disturbed(Pose pose) const {
        const Condition& condition = lap_.condition;
        if (condition.pose_noise_lateral_m == 0.0 && condition.pose_noise_yaw_rad == 0.0) return pose;
        Generator random = generator("pose noise");
        boost::random::normal_distribution<double> standard;
        const double to_left_m = condition.pose_noise_lateral_m * standard(random);
        const Point heading = pose.heading();
        pose.position = rounded(pose.position + to_left_m * Point(-heading.y(), heading.x()));
        pose.yaw_rad = rounded(pose.yaw_rad + condition.pose_noise_yaw_rad * standard(random), 1e9);
        return pose;
    }

    /// What becomes of each map point.
    [[nodiscard]] std::vector<Sight> look(const HalfDisc& view) const {
        Generator random = generator("misses");
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

    [[nodiscard]] std::vector<Cone> seen_cones(const std::vector<Sight>& sights) const {
        Generator random = generator("position noise");
        boost::random::normal_distribution<double> standard;
        std::vector<Cone> cones;
        for (std::size_t i = 0; i < sights.size(); ++i) {
            if (sights[i] != Sight::seen) continue;
            cones.push_back(course_.cones[i]);
            cones.back().position = *places_[i];
            if (const double sigma_m = lap_.condition.noise_sigma_m; sigma_m > 0.0) {
                const double x_m = sigma_m * standard(random);
                const double y_m = sigma_m * standard(random);
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
        Generator random = generator("false positives");
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

/// The condition as the options change it.
Condition adapted(Condition condition, const SceneOptions& options) {
    const Condition own = condition;
    condition.noise_sigma_m = options.noise_sigma_m.value_or(own.noise_sigma_m);
    condition.pose_noise_lateral_m = options.pose_noise_lateral_m.value_or(own.pose_noise_lateral_m);
    condition.pose_noise_yaw_rad = options.pose_noise_yaw_rad.value_or(own.pose_noise_yaw_rad);
    condition.miss_rate = options.miss_rate.value_or(own.miss_rate);
    condition.persistent = options.persistent.value_or(own.persistent);
    if (own.name.empty()) return condition;
    if (condition.noise_sigma_m != own.noise_sigma_m) condition.name += "+" + noise_text(condition);
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

void require_near_origin(const Point& position, const std::string& key) {
    if (!(position.cwiseAbs().maxCoeff() <= kMaxCoordinate_m)) {
        throw InvalidInput(key,
                           fmt::format("must be within {} m of the origin on each axis", kMaxCoordinate_m));
    }
}

}  // namespace

void validate(const SceneOptions& options) {
    constexpr double kMax = 1000.0;
    require_list(options.false_positive_rates, 0.0, kMaxRate, "fp");
    require_list(options.ranges_m, 0.1, kMax, "range");
    require_between(options.every_m, 0.01, kMax, "every");
    if (options.nearest == 0U) throw InvalidInput("nearest", "must be at least 1");
    static_cast<void>(conditions_of(options));
    require_between(options.noise_sigma_m.value_or(0.0), 0.0, kMax, "noise");
    require_between(options.pose_noise_lateral_m.value_or(0.0), 0.0, kMax, "pose-noise");
    require_between(options.pose_noise_yaw_rad.value_or(0.0), 0.0, kMax, "pose-noise");
    const double miss_rate = options.miss_rate.value_or(0.0);
    if (!(miss_rate >= 0.0 && miss_rate < 1.0)) {
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

std::vector<Condition> conditions_of(const SceneOptions& options) {
    if (options.conditions.empty()) return {adapted(Condition{}, options)};
    std::vector<Condition> conditions;
    for (const std::string& name : options.conditions) {
        const auto known = std::ranges::find(named_conditions(), name, &Condition::name);
        if (known == named_conditions().end()) {
            std::vector<std::string> names;
            for (const Condition& condition : named_conditions()) names.push_back(condition.name);
            throw InvalidInput("condition", fmt::format("'{}' is none of {}", name, fmt::join(names, ", ")));
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

namespace {

std::vector<Viewpoint> viewpoints_at(std::span<const Pose> poses) {
    std::vector<Viewpoint> viewpoints;
    for (const Pose& pose : poses) viewpoints.push_back({pose});
    return viewpoints;
}

/// Along the centre line of a track, or of a run its frames, one every so many metres of travel. Nothing
/// where no pose of the track can have a ground truth.
std::vector<Viewpoint> viewpoints_along(const Track& track, double every_m) {
    if (track.frames.empty()) return viewpoints_at(centre_line_poses(boundaries(track), every_m));
    std::vector<Viewpoint> viewpoints;
    double steps = 0.0;  // of every_m, to where the next frame is taken
    for (const RunFrame& frame : track.frames) {
        if (frame.travelled_m < steps * every_m) continue;
        viewpoints.push_back({frame.pose, &frame});
        steps = std::floor(frame.travelled_m / every_m) + 1.0;
    }
    return viewpoints;
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
    const double rate = options.false_positive_rates[lap % rates] + 0.0;  // -0 counts as 0
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
