#pragma once

#include "conelane/lane_graph_problem.hpp"

namespace conelane::experiments {

/// The cheapest lane graph that a beam search meets; none where it meets none. Both paths begin at a near
/// cone and grow edge by edge, always the one with fewer edges; a path ends at a far cone. Of all partial
/// lanes with the same number of edges the `width` cheapest stay, without the costs of ends that are still
/// open; of equally cheap ones those that were met first. A beam that is wide enough leaves nothing out, but
/// it never proves anything. Preconditions: the pairing is near_far, `width` is at least 1.
[[nodiscard]] std::optional<LaneGraph> beam_lane_graph(const LaneGraphProblem& problem, std::size_t width);

}  // namespace conelane::experiments
