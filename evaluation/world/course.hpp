#pragma once

#include "conelane/lane.hpp"
#include "conelane/scene.hpp"
#include "evaluation/world/scene_draws.hpp"
#include "evaluation/world/scene_options.hpp"
#include "evaluation/world/track.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <unordered_set>
#include <vector>

namespace conelane {

/// A place and the map from which a scene is seen.
struct Viewpoint {
    Pose pose;
    const RunFrame* frame = nullptr;  ///< of a run; absent: all cones of the track are on the map
};

/// Data that all scenes of a track share.
struct Course {
    const Track& track;
    TrackBoundaries polylines;
    std::vector<Cone> cones;  ///< of the track, with the ids and colors that scenes show
    std::unordered_set<ConeId> boundary_ids;
    std::vector<Viewpoint> lap;  ///< along the whole course; empty without persistent false positives
};

/// Ids and colors are drawn by the options' seed. No lap yet.
[[nodiscard]] Course make_course(const Track& track, const SceneOptions& options);

/// Number of ids for the cones of a track's scenes, with false positives.
[[nodiscard]] std::int64_t id_space(const Track& track);
/// An unused id of the first `space` ids; it is then in use.
[[nodiscard]] ConeId draw_new_id(SceneGenerator& generator, std::int64_t space,
                                 std::unordered_set<ConeId>& used);

[[nodiscard]] std::vector<Viewpoint> viewpoints_at(std::span<const Pose> poses);
/// Viewpoints along the centre line of a track every so many metres of travel, or the frames of a run.
/// Nothing if no pose of the track can have a ground truth.
[[nodiscard]] std::vector<Viewpoint> viewpoints_along(const Track& track, double every_m);

/// Position of each cone of the course on the map of a viewpoint; nothing for a cone that it lacks.
[[nodiscard]] std::vector<std::optional<Point>> places_of(const Course& course, const Viewpoint& viewpoint);

/// How a cone of the course appears in a scene.
enum class Sight { out_of_view, unmapped, missed, seen };

/// Both runs of seen cones (see generate_scenes), before the far ends are evened. `sights`: for each cone of
/// the course.
[[nodiscard]] Lane seen_lane(const Course& course, const std::vector<Sight>& sights, const Point& car);

}  // namespace conelane
