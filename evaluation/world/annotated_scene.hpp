#pragma once

#include "conelane/lane.hpp"

#include <unordered_map>

namespace conelane {

/// A scene with data that only the scoring may see.
struct AnnotatedScene {
    Scene scene;
    std::optional<Lane> ground_truth;
    std::string track;  ///< empty if the scene comes from no track
    std::optional<double> false_positive_rate;
    std::optional<double> range_m;
    std::optional<std::uint64_t> seed;  ///< the base seed
    std::string condition;              ///< empty without a named condition
    /// Map points in view that the car does not see, in the map's order. Recorded for named conditions, for
    /// persistent false positives, and for runs, whose map may lack them.
    std::vector<Cone> missed;
    std::optional<double> travelled_m;  ///< along the path of a run
};

/// The ground truth of the scene with only its `nearest` cones ahead (see cut_to_nearest). Nothing if a side
/// keeps fewer than two cones or the scene has no ground truth.
[[nodiscard]] std::optional<Lane> ground_truth_of_nearest(const AnnotatedScene& scene, std::size_t nearest);

/// The position of each cone in scene.cones by its id; only for look-up, its order is unspecified.
[[nodiscard]] inline std::unordered_map<ConeId, std::size_t> index_by_id(const Scene& scene) {
    std::unordered_map<ConeId, std::size_t> index_of;
    for (std::size_t i = 0; i < scene.cones.size(); ++i) index_of.emplace(scene.cones[i].id, i);
    return index_of;
}

/// A ground truth is degenerate below this share of the area that its length and width imply.
inline constexpr double kDegenerateAreaShare = 0.5;

/// Whether a ground truth is not a lane: the clockwise area between its boundaries is less than
/// kDegenerateAreaShare of their mean length times the median distance of a cone to the other boundary.
/// Between close legs of a course, one boundary may go on beside another leg, far beyond the end of the other
/// boundary. Precondition: all its cones are in the scene, at least two a side.
[[nodiscard]] bool is_degenerate(const Lane& ground_truth, const Scene& scene);

}  // namespace conelane
