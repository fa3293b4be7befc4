#pragma once

#include "conelane/lane.hpp"
#include "conelane/rld_parameters.hpp"
#include "evaluation/world/annotated_scene.hpp"
#include "experiments/tuning/evaluation.hpp"

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

namespace conelane::experiments {

/// Why the lane graph of least cost is, or is not, accurate on a scene. The first cause that applies.
enum class FailureCause {
    no_ground_truth,  ///< the cone set has fewer than two cones of a boundary: not counted
    accurate,
    // Inaccurate, and the ground truth itself is infeasible:
    breaks_spacing,    ///< by (27): an edge too short or too long
    breaks_angle,      ///< by (28): a turn too sharp
    breaks_width,      ///< by (6)-(8): its boundaries too close
    breaks_heading,    ///< by (9): fewer than two of its edges near the car along the heading
    breaks_endpoints,  ///< by (11)-(17) or the pairing: a forbidden position of its ends
    // Inaccurate, the ground truth is feasible, and another lane graph costs less, mostly in its
    cheaper_benefit,  ///< benefit: it has more edges
    cheaper_spacing,
    cheaper_angle,
    cheaper_heading,
    cheaper_color,
    cheaper_unevenness,  ///< and of the shape costs
    cheaper_facing,
    cheaper_near_ends,
    none_found,  ///< the ground truth is feasible, but the search reached the time limit without an answer
};
inline constexpr std::size_t kFailureCauseCount = 16;
[[nodiscard]] std::string_view to_string(FailureCause cause);

/// Cones that are selected but not in the ground truth, or missed, by their place on the boundary: before the
/// first cone shared with the ground truth, between, or after the last one. A boundary without a shared cone
/// is lost, with all its cones.
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
    std::optional<WrongCones> wrong;  ///< for an inaccurate answer; otherwise absent
};

/// Solves one scene by path-pair, with the cone set, context and time limit of the options. With a context
/// the cause refers to the ground truth of the context. Precondition: counts(annotated).
[[nodiscard]] Diagnosis diagnose(const AnnotatedScene& annotated, const RldParameters& parameters,
                                 const EvaluationOptions& options);

}  // namespace conelane::experiments
