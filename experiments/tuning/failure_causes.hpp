#pragma once

#include "conelane/lane.hpp"
#include "conelane/rld_parameters.hpp"
#include "evaluation/scenes/annotated_scene.hpp"
#include "experiments/tuning/evaluation.hpp"

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

namespace conelane::experiments {

/// Why the lane graph of least cost is, or is not, accurate on a scene. The first cause that applies.
enum class FailureCause {
    no_ground_truth,  ///< the cone set holds fewer than two cones of a boundary: not counted
    accurate,
    // Inaccurate, and the ground truth itself is infeasible:
    breaks_spacing,    ///< by (27): an edge too short or too long
    breaks_angle,      ///< by (28): a turn too sharp
    breaks_width,      ///< by (6)-(8): its boundaries too close
    breaks_heading,    ///< by (9): fewer than two of its edges near the car along the heading
    breaks_endpoints,  ///< by (11)-(17) or the pairing: its ends near, far or apart as they must not be
    // Inaccurate, the ground truth is feasible, and another lane graph costs less, mostly in its
    cheaper_benefit,  ///< benefit: it has more edges
    cheaper_spacing,
    cheaper_angle,
    cheaper_heading,
    cheaper_color,
    cheaper_unevenness,  ///< and of the shape costs
    cheaper_facing,
    cheaper_near_ends,
    none_found,  ///< the ground truth is feasible, yet the search stopped at the time limit before it
};
inline constexpr std::size_t kFailureCauseCount = 16;
[[nodiscard]] std::string_view to_string(FailureCause cause);

/// Cones that are chosen and not in the ground truth, or missed, by their place on the boundary: before the
/// first cone that it shares with the ground truth, after the last one, or between. A boundary that shares
/// none is lost, with all its cones.
struct WrongCones {
    std::size_t near_end = 0;
    std::size_t inside = 0;
    std::size_t far_end = 0;
    std::size_t on_lost_boundary = 0;

    bool operator==(const WrongCones&) const = default;
};
[[nodiscard]] WrongCones wrong_cones(const Lane& lane, const Lane& ground_truth);

struct Diagnosis {
    FailureCause cause = FailureCause::no_ground_truth;
    std::optional<WrongCones> wrong;  ///< of an inaccurate answer; absent where there is none
};

/// Solves one scene by path-pair, with the cone set, context and time limit of the options. With a context
/// the cause refers to the ground truth of the context. Precondition: counts(annotated).
[[nodiscard]] Diagnosis diagnose(const AnnotatedScene& annotated, const RldParameters& parameters,
                                 const EvaluationOptions& options);

}  // namespace conelane::experiments
