#pragma once

#include "conelane/scene.hpp"
#include "evaluation/world/annotated_scene.hpp"
#include "evaluation/world/scene_options.hpp"
#include "evaluation/world/track.hpp"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace conelane {

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
