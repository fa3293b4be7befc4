#include "learning/training/front_scenes.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/formats/track_spec.hpp"
#include "evaluation/seeded_random.hpp"
#include "evaluation/world/centre_line.hpp"
#include "evaluation/world/course.hpp"

#include <iterator>

#include <boost/random/uniform_real_distribution.hpp>
#include <fmt/format.h>

namespace conelane::learning {
namespace {

using Random = boost::random::mt19937_64;

constexpr double kPoseEvery_m = 0.5;
constexpr double kDegree_rad = std::numbers::pi / 180.0;
// How often and how much a course is changed and disturbed.
constexpr double kScaledShare = 0.7;
constexpr double kMaxLogScale = 0.22;
constexpr double kSwirledShare = 0.6;
constexpr double kMaxSwirl = 0.22;  ///< displacement per metre of each wave
constexpr double kRespacedShare = 0.5;
constexpr double kMinSpacing = 0.6;  ///< as a share of the course's spacing
constexpr double kMaxSpacing = 1.5;
constexpr double kSpacingJitter = 0.2;
constexpr double kMaxSpacing_m = 5.6;
constexpr double kOtherCourseShare = 0.35;
constexpr double kOtherCourseOff_m = 3.4;  ///< from the centre line, so outside the lane
constexpr double kDisturbedShare = 0.68;
constexpr double kMaxNoise_m = 0.2;
constexpr double kMaxMissed = 0.1;
constexpr double kMaxLateral_m = 0.5;
constexpr double kMaxYaw_rad = 8.0 * kDegree_rad;
constexpr double kShortSightShare = 0.15;
// Quality of the colors that are seen.
constexpr double kAllRightShare = 0.25;  ///< of the coloured ones: no color is wrong
constexpr double kMaxWrong = 0.35;       ///< share of the cones that show the other side's color
constexpr double kAllSeenShare = 0.35;   ///< no color is missing
constexpr double kMaxUnseen = 0.6;       ///< share of a side's cones whose color is not seen
constexpr double kUsualFalseShare =
    0.5;                             ///< a third of the false positives is of unknown color, else any share
constexpr double kSoftShare = 0.3;   ///< colors come as probabilities
constexpr double kCleanShare = 0.1;  ///< without false positives

double uniform(Random& random, double low, double high) {
    return boost::random::uniform_real_distribution<double>(low, high)(random);
}
bool one_in(Random& random, double share) {
    return uniform(random, 0.0, 1.0) < share;
}
std::size_t any_below(Random& random, std::size_t count) {
    return boost::random::uniform_int_distribution<std::size_t>(0, count - 1)(random);
}

/// A smooth map of the plane: mirrored, scaled, then moved by a few waves across their direction.
class Warp {
  public:
    Warp(Random& random, bool bends) {
        mirrored_ = one_in(random, 0.5);
        if (!bends) return;
        if (one_in(random, kScaledShare)) scale_ = std::exp(uniform(random, -kMaxLogScale, kMaxLogScale));
        if (!one_in(random, kSwirledShare)) return;
        for (Wave& wave : waves_) {
            const double direction_rad = uniform(random, 0.0, 2.0 * std::numbers::pi);
            const double number_1_m = 2.0 * std::numbers::pi / uniform(random, 35.0, 130.0);
            wave.number = number_1_m * Point(std::cos(direction_rad), std::sin(direction_rad));
            const double to_rad = uniform(random, 0.0, 2.0 * std::numbers::pi);
            wave.amplitude =
                uniform(random, 0.0, kMaxSwirl) / number_1_m * Point(std::cos(to_rad), std::sin(to_rad));
            wave.phase_rad = uniform(random, 0.0, 2.0 * std::numbers::pi);
        }
    }

    [[nodiscard]] bool mirrors() const { return mirrored_; }
    [[nodiscard]] Point operator()(Point point) const {
        if (mirrored_) point.y() = -point.y();
        point *= scale_;
        Point moved = point;
        for (const Wave& wave : waves_)
            moved += std::sin(wave.number.dot(point) + wave.phase_rad) * wave.amplitude;
        return moved;
    }

  private:
    struct Wave {
        Point number{0.0, 0.0};
        Point amplitude{0.0, 0.0};
        double phase_rad = 0.0;
    };
    bool mirrored_ = false;
    double scale_ = 1.0;
    std::array<Wave, 3> waves_;
};

/// A boundary with its cones placed again along it, with `spacing` times their old distances.
std::vector<Point> respaced(const std::vector<Point>& boundary, bool closed, double spacing, Random& random) {
    const auto last = static_cast<double>(closed ? boundary.size() : boundary.size() - 1);
    const auto at = [&](double place) {
        const auto index = std::min(static_cast<std::size_t>(place), boundary.size() - 1);
        const double share = place - static_cast<double>(index);
        return Point((1.0 - share) * boundary[index] + share * boundary[(index + 1) % boundary.size()]);
    };
    std::vector<Point> result;
    double place = closed ? uniform(random, 0.0, 1.0) : 0.0;
    const double end = last - (closed ? 0.5 * spacing - place : 0.0);
    while (place <= std::min(end, last)) {
        result.push_back(at(place));
        double step = spacing * (1.0 + uniform(random, -kSpacingJitter, kSpacingJitter));
        while (step > 1.0 && (at(std::min(place + step, last)) - result.back()).norm() > kMaxSpacing_m)
            step *= 0.9;
        place += step;
    }
    return result;
}

/// The course after the warp. The boundaries are swapped if it is mirrored or driven backwards.
Track changed(const Track& track, const Warp& warp, bool backwards, bool respace, Random& random) {
    const double spacing =
        respace && one_in(random, kRespacedShare) ? uniform(random, kMinSpacing, kMaxSpacing) : 1.0;
    Track result;
    result.closed = track.closed;
    std::array<std::vector<Point>, 2> sides;
    std::array<std::vector<ConeColor>, 2> colors;  // orange at gates
    std::vector<bool> is_boundary(track.cones.size(), false);
    const std::array<const std::vector<std::size_t>*, 2> runs{&track.left, &track.right};
    for (std::size_t side = 0; side < 2; ++side) {
        for (const std::size_t cone : *runs[side]) {
            sides[side].push_back(warp(track.cones[cone].position));
            colors[side].push_back(track.cones[cone].color);
            is_boundary[cone] = true;
        }
        if (backwards) std::ranges::reverse(sides[side]);
        if (backwards) std::ranges::reverse(colors[side]);
        if (spacing != 1.0) {
            std::vector<Point> moved = respaced(sides[side], track.closed, spacing, random);
            if (moved.size() >= 3) {
                sides[side] = std::move(moved);
                colors[side].assign(sides[side].size(), ConeColor::unknown);
            }
        }
    }
    if (warp.mirrors() != backwards) {
        std::swap(sides[0], sides[1]);
        std::swap(colors[0], colors[1]);
    }
    const auto add = [&](const Point& position, ConeColor color) {
        Cone cone;
        cone.id = static_cast<ConeId>(result.cones.size());
        cone.position = position;
        cone.color = color;
        result.cones.push_back(cone);
        return result.cones.size() - 1;
    };
    for (std::size_t i = 0; i < sides[0].size(); ++i) result.left.push_back(add(sides[0][i], colors[0][i]));
    for (std::size_t i = 0; i < sides[1].size(); ++i) result.right.push_back(add(sides[1][i], colors[1][i]));
    for (std::size_t i = 0; i < track.cones.size(); ++i) {
        // False cones are drawn for each scene; those that a run saw would be added to them.
        if (!is_boundary[i] && track.frames.empty()) add(warp(track.cones[i].position), track.cones[i].color);
    }
    return result;
}

Pose changed(const Pose& pose, const Warp& warp, bool backwards) {
    constexpr double kAhead_m = 0.3;
    const Point from = warp(pose.position - kAhead_m * pose.heading());
    const Point to = warp(pose.position + kAhead_m * pose.heading());
    const Point along = backwards ? Point(from - to) : Point(to - from);
    return {warp(pose.position), std::atan2(along.y(), along.x())};
}

/// Adds another course at a random angle through a place of this one, without the cones that would be on this
/// lane: parallel and crossing legs that may mislead a detector.
void add_other_course(Track& track, const std::vector<Pose>& poses, const Track& other, Random& random) {
    const Warp warp(random, true);
    const double angle_rad = uniform(random, 0.0, 2.0 * std::numbers::pi);
    const Point turned(std::cos(angle_rad), std::sin(angle_rad));
    const auto turn = [&](const Point& point) {
        return Point(turned.x() * point.x() - turned.y() * point.y(),
                     turned.y() * point.x() + turned.x() * point.y());
    };
    const Point through = turn(warp(other.cones[other.left[any_below(random, other.left.size())]].position));
    const Point aside(uniform(random, -12.0, 12.0), uniform(random, -12.0, 12.0));
    const Point shift = poses[any_below(random, poses.size())].position + aside - through;
    for (const std::vector<std::size_t>* side : {&other.left, &other.right}) {
        for (const std::size_t index : *side) {
            Cone cone;
            cone.id = static_cast<ConeId>(track.cones.size());
            cone.position = turn(warp(other.cones[index].position)) + shift;
            const auto is_near = [&](const Pose& pose) {
                return (pose.position - cone.position).squaredNorm() < kOtherCourseOff_m * kOtherCourseOff_m;
            };
            if (std::ranges::none_of(poses, is_near)) track.cones.push_back(cone);
        }
    }
}

/// Draws how the colors of a scene's cones are seen.
class ColorSight {
  public:
    explicit ColorSight(Random& random) : random_(random) {
        if (!one_in(random, kAllRightShare)) wrong_ = uniform(random, 0.0, kMaxWrong);
        if (!one_in(random, kAllSeenShare)) {
            unseen_[0] = uniform(random, 0.0, kMaxUnseen);
            unseen_[1] = one_in(random, 0.5) ? unseen_[0] : uniform(random, 0.0, kMaxUnseen);
        }
        if (!one_in(random, kUsualFalseShare)) false_unseen_ = uniform(random, 0.0, 1.0);
        soft_ = one_in(random, kSoftShare);
    }

    /// `boundary`: the true color of a cone of a boundary; nothing for any other cone.
    void show(Cone& cone, std::optional<ConeColor> boundary) const {
        const bool is_false = !boundary;
        cone.color = is_false ? (one_in(random_, 0.5) ? ConeColor::blue : ConeColor::yellow) : *boundary;
        const double unseen = is_false ? false_unseen_ : unseen_[cone.color == ConeColor::yellow ? 1 : 0];
        if (one_in(random_, unseen)) cone.color = ConeColor::unknown;
        if (cone.color == ConeColor::unknown) return;
        // The label is wrong with the probability that the softened color states.
        const bool is_drawn = soft_ && wrong_ > 0.0;
        const double wrong = is_drawn ? uniform(random_, 0.0, std::min(0.5, 2.0 * wrong_)) : wrong_;
        const bool is_gate = is_orange(cone.color);
        if (!is_false && !is_gate && one_in(random_, wrong))
            cone.color = cone.color == ConeColor::blue ? ConeColor::yellow : ConeColor::blue;
        if (!soft_) return;
        ColorProbabilities soft;
        soft.unknown = uniform(random_, 0.0, 0.2);
        const double known = 1.0 - soft.unknown;
        soft.blue = known * (cone.color == ConeColor::blue ? 1.0 - wrong : is_gate ? 0.0 : wrong);
        soft.yellow = known * (cone.color == ConeColor::yellow ? 1.0 - wrong : is_gate ? 0.0 : wrong);
        if (is_gate) (one_in(random_, 0.5) ? soft.orange : soft.big_orange) = known;
        cone.color_probabilities = soft;
    }

  private:
    Random& random_;
    double wrong_ = 0.0;
    std::array<double, 2> unseen_{};
    double false_unseen_ = 1.0 / 3.0;
    bool soft_ = false;
};

/// Shows the colors of a scene of that track, made with these options.
void show_colors(Scene& scene, const Track& track, SceneOptions options, Random& random) {
    options.with_color = true;
    const Course course = make_course(track, options);
    std::unordered_map<ConeId, ConeColor> true_colors;  // of the boundaries, for look-up only
    for (const Cone& cone : course.cones) {
        if (course.boundary_ids.contains(cone.id)) true_colors.emplace(cone.id, cone.color);
    }
    const ColorSight sight(random);
    for (Cone& cone : scene.cones) {
        const auto known = true_colors.find(cone.id);
        sight.show(cone, known == true_colors.end() ? std::nullopt : std::optional(known->second));
    }
}

/// Adds this many false positives, anywhere in view.
void add_false_positives(Scene& scene, long count, double range_m, Random& random) {
    ConeId id = 0;
    for (const Cone& cone : scene.cones) id = std::max(id, cone.id);
    const HalfDisc view{scene.pose.position, scene.pose.heading(), range_m};
    const Point to_left(-view.heading.y(), view.heading.x());
    for (long i = 0; i < count; ++i) {
        Cone cone;
        cone.id = ++id;
        do {
            const double ahead_m = uniform(random, 0.0, range_m);
            cone.position =
                view.centre + ahead_m * view.heading + uniform(random, -range_m, range_m) * to_left;
        } while (!view.contains(cone.position));
        scene.cones.push_back(cone);
    }
}

}  // namespace

OptionFields draw_fields(DrawnTrainingOptions& options, bool with_noise) {
    FrontSceneOptions& scenes = options.scenes;
    OptionFields fields{
        {"--seed", "seed", &options.seed, kAny, "seed of all random draws"},
        {"--draws", "draws_per_step", &options.draws_per_step, kCount, "changed courses in each step"},
        {"--scenes-a-draw", "scenes.per_draw", &scenes.scenes_per_draw, kCount,
         "scenes of each changed course"},
        {"!--no-warp", "scenes.warp", &scenes.warp, kAny, "courses keep their shape"},
        {"!--no-respacing", "scenes.respace", &scenes.respace, kAny,
         "cones stay where they are on their boundary"},
        {"!--no-disturbance", "scenes.disturb", &scenes.disturb, kAny,
         "no noise, missed cones and pose error"},
        {"!--no-short-sight", "scenes.short_sight", &scenes.short_sight, kAny,
         "true cones are seen as far as false ones"},
        {"--other-course", "scenes.other_course", &scenes.other_course, kAny,
         "a second course lies beside the first in a third of the draws"},
        {"--colored-share", "scenes.colored_share", &scenes.colored_share, kShare,
         "share of the draws whose cones have colours"}};
    if (with_noise) {
        fields.insert(fields.end(),
                      {{"--noise-share", "scenes.noise_share", &scenes.noise_share, kShare,
                        "share of the draws that have a scene of false cones alone, for the judge"},
                       {"--noise-cones", "scenes.noise_cones", &scenes.noise_cones, kCount,
                        "fewest and most cones of such a scene"},
                       {"--noise-ranges", "scenes.noise_ranges_m", &scenes.noise_ranges_m, kPositive,
                        "smallest and largest radius of the half disc that holds them [m]"}});
    }
    fields.push_back({"--highest-rate",
                      "scenes.highest_rate",
                      &scenes.highest_rate,
                      {0.0, 0.99, true},
                      "share of false positives is drawn up to this"});
    return fields;
}

OptionFields run_fields(DrawnTrainingOptions& options, const char* report_option) {
    return {{report_option, "", &options.report_every, kCount,
             "steps between two lines of output, and figures if tracks are held out"},
            {"--checkpoint", "", &options.checkpoint, kAny,
             "file of the training's state, from which a stopped training resumes"},
            {"--checkpoint-every", "", &options.checkpoint_every, kCount, "steps between two writes of it"},
            {"--threads", "", &options.threads, {1.0, 1024.0}, "the weights are the same with any number"}};
}

LearningLoop loop_of(const DrawnTrainingOptions& options, double smallest_deviation, std::string identity,
                     bool reports) {
    return {.smallest_deviation = smallest_deviation,
            .threads = options.threads,
            .report_every = reports ? options.report_every : 0,
            .identity = std::move(identity),
            .checkpoint = options.checkpoint,
            .checkpoint_every = options.checkpoint_every};
}

std::vector<Track> annotated_tracks(const std::vector<std::string>& specs) {
    std::vector<Track> tracks;
    for (const std::string& spec : specs)
        std::ranges::move(load_tracks_aloud(spec), std::back_inserter(tracks));
    std::erase_if(tracks, [](const Track& track) { return track.left.empty() || track.right.empty(); });
    return tracks;
}

FrontScenes::FrontScenes(std::vector<Track> courses, const FrontSceneOptions& options, std::uint64_t seed)
    : options_(options), seed_(seed) {
    if (courses.empty()) throw InvalidInput("tracks", "there is none to train on");
    for (Track& track : courses) {
        std::vector<Pose> poses = centre_line_poses(boundaries(track), kPoseEvery_m);
        if (poses.empty()) throw InvalidInput("tracks", track.name + " has no centre line");
        courses_.push_back({std::move(track), std::move(poses)});
    }
}

FrontScenes::Drawn FrontScenes::draw(std::uint64_t number) const {
    const std::string name = fmt::format("front/{}", number);
    Random random = generator_of(name, seed_);
    const Course& course = courses_[any_below(random, courses_.size())];
    const Warp warp(random, options_.warp);
    const bool backwards = one_in(random, 0.5);
    Track track = changed(course.track, warp, backwards, options_.respace, random);
    std::vector<Pose> poses;
    for (const Pose& pose : course.poses) poses.push_back(changed(pose, warp, backwards));
    if (options_.other_course && one_in(random, kOtherCourseShare)) {
        add_other_course(track, poses, courses_[any_below(random, courses_.size())].track, random);
    }
    Random color_random = generator_of(name + "/colors", seed_);
    const bool colored = one_in(color_random, options_.colored_share);
    Drawn drawn;
    drawn.boundaries = boundaries(track);
    for (std::size_t i = 0; i < options_.scenes_per_draw; ++i) {
        track.name = fmt::format("{}/{}", name, i);
        const Pose pose = poses[any_below(random, poses.size())];
        SceneOptions scenes;
        scenes.seed = seed_;
        const double kind = uniform(random, 0.0, 1.0);
        const double range_m = kind < 0.4 ? 30.0 : kind < 0.8 ? 50.0 : uniform(random, 25.0, 55.0);
        const double rate = one_in(random, kCleanShare) ? 0.0 : uniform(random, 0.0, options_.highest_rate);
        if (options_.disturb && one_in(random, kDisturbedShare)) {
            scenes.noise_sigma_m = uniform(random, 0.0, kMaxNoise_m);
            scenes.miss_rate = uniform(random, 0.0, kMaxMissed);
            scenes.pose_noise_lateral_m = uniform(random, 0.0, kMaxLateral_m);
            scenes.pose_noise_yaw_rad = uniform(random, 0.0, kMaxYaw_rad);
        }
        const bool short_sight = options_.short_sight && one_in(random, kShortSightShare);
        scenes.ranges_m = {short_sight ? range_m * uniform(random, 0.6, 0.95) : range_m};
        scenes.false_positive_rates = {short_sight ? 0.0 : rate};
        for (AnnotatedScene& scene : generate_scenes(track, std::span(&pose, 1), scenes)) {
            if (short_sight) {
                // The cones of the course are seen only to a shorter distance.
                const auto seen = static_cast<double>(scene.scene.cones.size());
                add_false_positives(scene.scene, std::lround(rate * seen / (1.0 - rate)), range_m, random);
            }
            if (colored) show_colors(scene.scene, track, scenes, color_random);
            drawn.scenes.push_back(std::move(scene));
        }
    }
    Random noise_random = generator_of(name + "/noise", seed_);
    if (one_in(noise_random, options_.noise_share)) {
        Scene noise;
        noise.id = name + "/noise";
        const auto [fewest, most] = options_.noise_cones;
        const std::size_t count = fewest + any_below(noise_random, most - fewest + 1);
        const auto [nearest_m, farthest_m] = options_.noise_ranges_m;
        // A distribution without width would never give a number.
        const double range_m =
            nearest_m < farthest_m ? uniform(noise_random, nearest_m, farthest_m) : nearest_m;
        add_false_positives(noise, static_cast<long>(count), range_m, noise_random);
        if (colored) {
            const ColorSight sight(noise_random);
            for (Cone& cone : noise.cones) sight.show(cone, std::nullopt);
        }
        drawn.noise.push_back(std::move(noise));
    }
    return drawn;
}

}  // namespace conelane::learning
