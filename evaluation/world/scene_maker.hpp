#pragma once

#include "evaluation/world/annotated_scene.hpp"
#include "evaluation/world/course.hpp"

#include <cstddef>
#include <optional>
#include <vector>

namespace conelane {

/// Data that the scenes of one lap share.
struct Lap {
    Condition condition;
    double rate;
    double range_m;
    std::vector<Cone> persistent;  ///< false positives in the world
};

/// The scene from a viewpoint. Nothing if a run of the ground truth has fewer than two cones, or no cone is
/// seen. A degenerate ground truth is left out of its scene.
[[nodiscard]] std::optional<AnnotatedScene> make_scene(const Course& course, const SceneOptions& options,
                                                       const Lap& lap, const Viewpoint& viewpoint,
                                                       std::size_t pose_index);

}  // namespace conelane
