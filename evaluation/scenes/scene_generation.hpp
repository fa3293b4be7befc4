#pragma once

#include "conelane/scene.hpp"
#include "evaluation/scenes/annotated_scene.hpp"
#include "evaluation/scenes/condition.hpp"
#include "evaluation/tracks/track.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace conelane {

/// Which scenes a track gives. Lists hold distinct values.
struct SceneOptions {
    std::vector<double> false_positive_rates;  ///< false positives / all points of the scene, in [0, 0.99]
    std::vector<double> ranges_m;              ///< radius of the visible half disc, in [0.1, 1000]
    double every_m = 1.1;                      ///< travel between poses, in [0.01, 1000]
    std::optional<std::size_t> nearest;        ///< keep this many cones ahead, at least one; all where absent
    /// Names of conditions, in whose order the laps come. Where none is named there is one, without a name.
    std::vector<std::string> conditions;
    // What is set below holds in every condition, in place of the condition's own; see Condition.
    std::optional<double> noise_sigma_m;
    std::optional<double> pose_noise_lateral_m;
    std::optional<double> pose_noise_yaw_rad;
    std::optional<double> miss_rate;  ///< in [0, 1)
    std::optional<bool> persistent;
    bool with_color = false;  ///< else every cone is of unknown color
    /// Share of the map's blue and yellow cones seen in the other color, in [0, 1]; only with color.
    double color_error_rate = 0.0;
    /// Else every confidence is 1. A cone of a boundary draws its confidence from Beta(5, 2) (mean 0.71), any
    /// other point from Beta(2, 4) (mean 0.33): the cone's is the higher one in 93 % of such pairs.
    bool with_confidence = false;
    std::uint64_t seed = 0;  ///< base seed
    unsigned threads = 1;    ///< at most; more than there are processors are not used
};

/// Throws InvalidInput naming the option where a value is out of its range.
void validate(const SceneOptions& options);

/// The conditions that the options ask for, at least one. Where an option changes a named one, its name says
/// so: "car+miss_0", "car+fresh". Throws InvalidInput where a condition is unknown or named twice.
[[nodiscard]] std::vector<Condition> conditions_of(const SceneOptions& options);
/// Their names, for records of a run; empty where none is named.
[[nodiscard]] std::vector<std::string> condition_names(const SceneOptions& options);

/// The scenes that a car sees along a track, with their ground truth; those with none (a run below two cones)
/// or a degenerate one are left out. Where the track has but a driven path, all scenes with a cone are made.
/// Order: condition, range, rate, pose, so that the scenes of a lap follow one another.
///
/// The pose with index i in `poses` gives the scene "TRACK/pose_i/fp_RATE/range_RANGE", with a part more for
/// the condition (but `paper`), else for each disturbance, and for `nearest`. Its content depends on nothing
/// but the track, that pose, its index, and the options that it shows: neither on other rates, ranges and
/// poses nor on the number of threads. A cone of the track keeps its id in all scenes of one base seed; ids
/// and order tell nothing of what a cone is.
///
/// False positives that persist are drawn once for a track, condition, range and rate, in the world that the
/// car has in view on a lap of the centre line, wherever `poses` are: about as many in view as there would be
/// of fresh ones.
///
/// Throws InvalidInput on options out of range, on a track or pose that is not finite or beyond 1e8 m, and
/// where false positives persist on a track without a centre line or are more than there are ids.
[[nodiscard]] std::vector<AnnotatedScene> generate_scenes(const Track& track, std::span<const Pose> poses,
                                                          const SceneOptions& options);

struct Course;  ///< what all scenes of a track share

/// From where, and by which map, a scene is seen.
struct Viewpoint {
    Pose pose;
    const RunFrame* frame = nullptr;  ///< of a run; else all cones of the track are on the map
};

/// The scenes of `generate_scenes` lap by lap, for who does not want all of them in memory. A lap is one
/// condition, range and rate; `track` and `options` must outlive the object.
class TrackLaps {
  public:
    /// Both throw like generate_scenes.
    TrackLaps(const Track& track, std::span<const Pose> poses, const SceneOptions& options);
    TrackLaps(const Track& track, const SceneOptions& options);
    ~TrackLaps();
    TrackLaps(const TrackLaps&) = delete;
    TrackLaps& operator=(const TrackLaps&) = delete;

    [[nodiscard]] std::size_t size() const;  ///< conditions times ranges times rates
    /// The scenes of a lap by pose, maybe none, degenerate ground truths absent. Precondition: lap < size().
    [[nodiscard]] std::vector<AnnotatedScene> make(std::size_t lap) const;
    /// Whether `make` would give none with a ground truth, found out with as few scenes as possible.
    [[nodiscard]] bool is_empty(std::size_t lap) const;

  private:
    TrackLaps(const Track& track, std::vector<Viewpoint> viewpoints, const SceneOptions& options);

    std::vector<Viewpoint> viewpoints_;
    const SceneOptions& options_;
    std::vector<Condition> conditions_;
    std::unique_ptr<const Course> course_;  ///< none where no pose of the track can have a ground truth
};

/// The same along the track's centre line, a pose every `every_m` of travel (see centre_line_poses, whose
/// InvalidInput it passes on). Along a run, a frame every `every_m` of its travel: its pose, and of the cones
/// those that its map holds, where they are on it. A cone in view that it lacks counts as missed where it
/// stands alone on its boundary; the ground truth ends before two in a row.
[[nodiscard]] std::vector<AnnotatedScene> generate_scenes(const Track& track, const SceneOptions& options);

}  // namespace conelane
