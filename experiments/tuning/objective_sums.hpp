#pragma once

#include "conelane/lane_graph.hpp"
#include "conelane/lane_graph_problem.hpp"
#include "conelane/rld_parameters.hpp"

#include <array>
#include <cstddef>

namespace conelane::experiments {

/// The factor of each weight of the objective: of (29), and of the terms for color and shape.
enum class ObjectiveTerm { benefit, spacing, angle, heading, color, unevenness, facing, near_ends };
inline constexpr std::size_t kObjectiveTermCount = 8;

/// The weights in the order of the terms.
inline constexpr std::array<double RldParameters::*, kObjectiveTermCount> kObjectiveWeights{
    &RldParameters::w_b,           &RldParameters::w_s,
    &RldParameters::w_t,           &RldParameters::w_p,
    &RldParameters::w_color,       &RldParameters::unevenness_weight,
    &RldParameters::facing_weight, &RldParameters::near_end_weight};

/// Each term of a lane graph's objective without its weight: the objective is the sum of weights times these
/// terms. Benefit and near ends are at most zero.
using ObjectiveSums = std::array<double, kObjectiveTermCount>;

/// Zero for w_b, w_u and w_v where those are zero. Preconditions: every edge is listed in the problem, and no
/// costs are learned.
[[nodiscard]] ObjectiveSums objective_sums(const LaneGraphProblem& problem, const LaneGraph& graph);

}  // namespace conelane::experiments
