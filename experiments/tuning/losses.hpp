#pragma once

#include "experiments/scenes/annotated_scene.hpp"
#include "model/rld_parameters.hpp"

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

namespace conelane::experiments {

/// Why the lane graph of least cost is, or is not, accurate on a scene. The first that fits.
enum class Loss {
    no_ground_truth,  ///< the cone set holds fewer than two cones of a boundary: not counted
    accurate,
    spacing,      ///< inaccurate, and the ground truth itself breaks (27): an edge too short or too long
    angle,        ///< or (28): a turn too sharp
    width,        ///< or (6)-(8): its boundaries too close
    heading,      ///< or (9): fewer than two of its edges near the car along the heading
    endpoints,    ///< or (11)-(17) or the pairing: its ends near, far or apart as they must not be
    cheaper_one,  ///< the ground truth is feasible, another lane graph costs less
    none_found,   ///< the ground truth is feasible, yet stopped at the time limit
};
inline constexpr std::size_t kLossCount = 9;
[[nodiscard]] std::string_view to_string(Loss loss);

/// Solves one scene by path-pair. Precondition: counts(scene).
[[nodiscard]] Loss loss_on(const AnnotatedScene& scene, const RldParameters& parameters,
                           std::optional<std::size_t> nearest, double time_limit_ms);

}  // namespace conelane::experiments
