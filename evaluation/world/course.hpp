#pragma once

#include "conelane/lane.hpp"
#include "conelane/point.hpp"
#include "conelane/scene.hpp"
#include "evaluation/world/scene_options.hpp"
#include "evaluation/world/track.hpp"
#include "model/geometry.hpp"

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <unordered_set>
#include <vector>

#include <boost/random/mersenne_twister.hpp>

namespace conelane {

using SceneGenerator = boost::random::mt19937_64;

/// A generator for one purpose, so that draws for one purpose do not change those for another: FNV-1a over
/// the text, then the finaliser of splitmix64.
inline SceneGenerator generator_for(std::string_view text) {
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
    return SceneGenerator(hash);
}

/// Drawn numbers are rounded, because the last bits of sine, cosine and logarithm differ between C libraries.
inline double rounded(double value, double steps_per_unit) {
    return std::round(value * steps_per_unit) / steps_per_unit;
}
inline Point rounded(const Point& point) {
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

/// Draws ids and, with colors, colors of false positives of a course.
class FalsePositives {
  public:
    FalsePositives(const Course& course, bool with_color);

    [[nodiscard]] Cone draw(const Point& position, SceneGenerator& random);

  private:
    std::int64_t space_;
    bool with_color_;
    std::unordered_set<ConeId> used_;
};

/// Number of false positives for this many seen points: k / (seen + k) = rate.
[[nodiscard]] long false_positives_to(double seen, double rate);

/// The false positives that persist along a lap of the course; none if the condition has none.
[[nodiscard]] std::vector<Cone> persistent_false_positives(const Course& course, const SceneOptions& options,
                                                           const Condition& condition, double rate,
                                                           double range_m);

/// The wanted number of persistent points in view from one place.
struct PersistentView {
    HalfDisc view;
    double expected_points = 0.0;
};

/// Points drawn once in the world that `views` cover. Their density at a place is the mean of the densities
/// that the views containing it want, so each view is expected to hold about its number, exactly so if all
/// want the same. All views have one radius, that of the first.
[[nodiscard]] std::vector<Point> draw_persistent_points(std::span<const PersistentView> views,
                                                        boost::random::mt19937_64& random);

}  // namespace conelane
