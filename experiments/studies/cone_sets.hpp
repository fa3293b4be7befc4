#pragma once

#include "conelane/rld_parameters.hpp"
#include "evaluation/world/annotated_scene.hpp"

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace conelane::experiments {

/// Cone sets of given sizes, for studies that measure by size.
struct ConeSetOptions {
    RldParameters parameters;
    std::vector<std::size_t> sizes;
    std::optional<std::size_t>
        limit;                   ///< largest number of scenes of each size, evenly spread; all if absent
    double time_limit_ms = 0.0;  ///< of a solve
};

/// The scenes that have `size` cones ahead and pass `wanted`; at most `limit` of them, evenly spread.
[[nodiscard]] std::vector<const AnnotatedScene*> scenes_of_size(
    std::span<const AnnotatedScene> scenes, std::size_t size, std::optional<std::size_t> limit,
    const std::function<bool(const AnnotatedScene&)>& wanted);

/// Objectives that differ by at most this are equal: the possible error of a solver's answer, see
/// SolveLimits.
inline constexpr double kObjectiveTolerance = 1e-6;

/// (objective - optimum) / max(1, |optimum|), at least 0.
[[nodiscard]] double relative_gap(double objective, double optimum);

}  // namespace conelane::experiments
