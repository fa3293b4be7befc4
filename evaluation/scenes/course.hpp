#pragma once

#include "conelane/lane.hpp"
#include "conelane/scene.hpp"
#include "evaluation/scenes/scene_draws.hpp"
#include "evaluation/scenes/scene_options.hpp"
#include "evaluation/tracks/track.hpp"
#include "evaluation/tracks/track_boundaries.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_set>
#include <vector>

namespace conelane {

/// From where, and by which map, a scene is seen.
struct Viewpoint {
    Pose pose;
    const RunFrame* frame = nullptr;  ///< of a run; else all cones of the track are on the map
};

/// What all scenes of a track share.
struct Course {
    const Track& track;
    TrackBoundaries polylines;
    std::vector<Cone> cones;  ///< of the track, with the ids and colors that scenes show
    std::unordered_set<ConeId> boundary_ids;
    std::vector<Viewpoint> lap;  ///< along the whole course; empty where no false positives persist
};

/// Ids and colors are drawn by the options' seed. No lap yet.
[[nodiscard]] Course make_course(const Track& track, const SceneOptions& options);

/// How many ids there are for the cones of a track's scenes, false positives included.
[[nodiscard]] std::int64_t id_space(const Track& track);
/// An id of the first `space` that is not in use, which it is from then on.
[[nodiscard]] ConeId draw_new_id(SceneGenerator& generator, std::int64_t space,
                                 std::unordered_set<ConeId>& used);

[[nodiscard]] std::vector<Viewpoint> viewpoints_at(std::span<const Pose> poses);
/// Along the centre line of a track, or of a run its frames, one every so many metres of travel. Nothing
/// where no pose of the track can have a ground truth.
[[nodiscard]] std::vector<Viewpoint> viewpoints_along(const Track& track, double every_m);

/// Where the map of a viewpoint has each cone of the course, nothing where it lacks it.
[[nodiscard]] std::vector<std::optional<Point>> places_of(const Course& course, const Viewpoint& viewpoint);

/// What becomes of a cone of the course in a scene.
enum class Sight { out_of_view, unmapped, missed, seen };

/// Both runs of seen cones (see generate_scenes), whose far ends are not evened. `sights`: of each cone of
/// the course.
[[nodiscard]] Lane seen_lane(const Course& course, const std::vector<Sight>& sights, const Point& car);

}  // namespace conelane
