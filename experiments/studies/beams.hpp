#pragma once

#include "conelane/lane_graph_problem.hpp"
#include "model/strip_problem.hpp"

/// Beam searches over the costs of the exact ones. A beam that is wide enough leaves nothing out, but it
/// never proves anything. Precondition of both: `width` is at least 1.
namespace conelane::experiments {

/// The cheapest lane graph that a beam search meets; none where it meets none. Both paths begin at a near
/// cone and grow edge by edge, always the one with fewer edges; a path ends at a far cone. Of all partial
/// lanes with the same number of edges the `width` cheapest stay, without the costs of ends that are still
/// open; of equally cheap ones those that were met first. Precondition: the pairing is near_far.
[[nodiscard]] std::optional<LaneGraph> beam_lane_graph(const LaneGraphProblem& problem, std::size_t width);

/// The cheapest strip that a beam search meets; none where it meets none. Strips grow from rung to rung, and
/// use no cone twice. Of all partial strips with the same number of triangles the `width` cheapest stay,
/// without the costs of their ends; of those with the same cones and last edges one.
[[nodiscard]] std::optional<StripLane> beam_strip(const StripProblem& problem, std::size_t width);

}  // namespace conelane::experiments
