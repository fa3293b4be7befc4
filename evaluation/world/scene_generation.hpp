#pragma once

#include "evaluation/world/annotated_scene.hpp"
#include "evaluation/world/track.hpp"

#include <memory>

namespace conelane {

/// Disturbances between the map of a course and the cones that a car sees.
struct Condition {
    std::string name;                   ///< empty without a name
    double noise_sigma_m = 0.0;         ///< Gaussian, on each coordinate of a seen map point
    double pose_noise_lateral_m = 0.0;  ///< Gaussian, across the heading
    double pose_noise_yaw_rad = 0.0;    ///< Gaussian
    double miss_rate = 0.0;             ///< share of visible map points not seen
    bool persistent = false;            ///< false positives keep id and place along a lap
    /// Standard deviation of each coordinate that is added to noise_sigma_m for each metre between cone and
    /// car, as the root of the sum of squares. Above 0 every cone of a scene carries its covariance.
    double noise_by_range = 0.0;

    /// Standard deviation of each coordinate of a point seen at that distance [m].
    [[nodiscard]] double noise_m(double distance_m) const;
};

/// Named conditions, so that tables can be compared: `paper`, undisturbed, `car`, `harsh` and `slam`.
[[nodiscard]] std::span<const Condition> named_conditions();

/// How names of conditions and ids of scenes spell the disturbances: "noise_0.1", "pose_noise_0.3_0.09",
/// "miss_0.05", "noise_by_range_0.01".
[[nodiscard]] std::string noise_text(const Condition& condition);
[[nodiscard]] std::string pose_noise_text(const Condition& condition);
[[nodiscard]] std::string miss_text(const Condition& condition);
[[nodiscard]] std::string noise_by_range_text(const Condition& condition);
/// The texts of the condition's disturbances, and "persist", in the order of ids.
[[nodiscard]] std::vector<std::string> disturbances(const Condition& condition);

/// Which scenes a track gives. The values of a list are distinct.
struct SceneOptions {
    std::vector<double> false_positive_rates;  ///< false positives / all points of the scene, in [0, 0.99]
    std::vector<double> ranges_m;              ///< radius of the visible half disc, in [0.1, 1000]
    double every_m = 1.1;                      ///< travel between poses, in [0.01, 1000]
    std::optional<std::size_t> nearest;        ///< keep this many cones ahead, at least one; all if absent
    /// Names of conditions, in the order of the laps. If empty, there is one condition without a name.
    std::vector<std::string> conditions;
    // These values replace those of every condition; see Condition.
    std::optional<double> noise_sigma_m;
    std::optional<double> noise_by_range;  ///< in [0, 1]
    std::optional<double> pose_noise_lateral_m;
    std::optional<double> pose_noise_yaw_rad;
    std::optional<double> miss_rate;  ///< in [0, 1)
    std::optional<bool> persistent;
    bool with_color = false;  ///< false: every cone is of unknown color
    /// Share of the map's blue and yellow cones seen in the other color, in [0, 1]; only with color.
    double color_error_rate = 0.0;
    /// Share of the map's cones whose color is not seen, in [0, 1]; only with color. Of the other blue or
    /// yellow cones color_error_rate is wrong. False positives are blue, yellow or of unknown color, a third
    /// each, whatever the two rates are.
    double color_unknown_rate = 0.0;
    /// Without it every confidence is 1. A cone of a boundary draws its confidence from Beta(5, 2) (mean
    /// 0.71), any other point from Beta(2, 4) (mean 0.33): the cone's is the higher one in 93 % of such
    /// pairs.
    bool with_confidence = false;
    std::uint64_t seed = 0;  ///< base seed
    unsigned threads = 1;    ///< largest number; at most the number of processors is used
};

/// Throws InvalidInput naming the option where a value is out of its range.
void validate(const SceneOptions& options);

/// The conditions that the options ask for, at least one. Where an option changes a named one, its name says
/// so: "car+miss_0", "car+no_persist". Throws InvalidInput if a condition is unknown or named twice.
[[nodiscard]] std::vector<Condition> conditions_of(const SceneOptions& options);
/// Their names, for records of a run; empty if none is named.
[[nodiscard]] std::vector<std::string> condition_names(const SceneOptions& options);

/// The scenes that a car sees along a track, with their ground truth; scenes without a ground truth (a run
/// below two cones) or with a degenerate one are left out. If the track has only a driven path, all scenes
/// with a cone are made. Order: condition, range, rate, pose, so the scenes of a lap follow one another.
///
/// The pose with index i in `poses` gives the scene "TRACK/pose_i/fp_RATE/range_RANGE", followed by the
/// condition (except `paper`), or else by each disturbance, and by `nearest`. Its content depends only on the
/// track, the pose, its index and the options in its name: not on other rates, ranges and poses, nor on the
/// number of threads. A cone of the track keeps its id in all scenes of one base seed; ids and order do not
/// reveal what a cone is.
///
/// Persistent false positives are drawn once for a track, condition, range and rate, in the area that the car
/// sees on a lap of the centre line, for any `poses`: about as many in view as without persistence.
///
/// Throws InvalidInput for options out of range, for a track or pose that is not finite or beyond 1e8 m, and
/// if false positives persist on a track without a centre line or exceed the number of ids.
[[nodiscard]] std::vector<AnnotatedScene> generate_scenes(const Track& track, std::span<const Pose> poses,
                                                          const SceneOptions& options);

struct Course;
struct Viewpoint;

/// The scenes of `generate_scenes` lap by lap, to keep only one lap in memory. A lap is one condition, range
/// and rate; `track` and `options` must outlive the object.
class TrackLaps {
  public:
    /// Both throw like generate_scenes.
    TrackLaps(const Track& track, std::span<const Pose> poses, const SceneOptions& options);
    TrackLaps(const Track& track, const SceneOptions& options);
    ~TrackLaps();
    TrackLaps(const TrackLaps&) = delete;
    TrackLaps& operator=(const TrackLaps&) = delete;

    [[nodiscard]] std::size_t size() const;  ///< conditions times ranges times rates
    /// The scenes of a lap by pose, possibly none, without degenerate ground truths. Precondition: lap <
    /// size().
    [[nodiscard]] std::vector<AnnotatedScene> make(std::size_t lap) const;
    /// Whether `make` would give none with a ground truth, determined with as few scenes as possible.
    [[nodiscard]] bool is_empty(std::size_t lap) const;

  private:
    TrackLaps(const Track& track, std::vector<Viewpoint> viewpoints, const SceneOptions& options);

    std::vector<Viewpoint> viewpoints_;
    const SceneOptions& options_;
    std::vector<Condition> conditions_;
    std::unique_ptr<const Course> course_;  ///< absent if no pose of the track can have a ground truth
};

/// The same along the track's centre line, a pose every `every_m` of travel (see centre_line_poses, whose
/// InvalidInput it passes on). Along a run, a frame every `every_m` of its travel: its pose, and of the cones
/// those that its map holds, where they are on it. A cone in view that it lacks counts as missed where it
/// stands alone on its boundary; the ground truth ends before two in a row.
[[nodiscard]] std::vector<AnnotatedScene> generate_scenes(const Track& track, const SceneOptions& options);

}  // namespace conelane
