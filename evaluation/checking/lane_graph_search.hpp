#pragma once

#include "conelane/lane_graph.hpp"
#include "conelane/rld_parameters.hpp"
#include "conelane/scene.hpp"

#include <optional>

namespace conelane {

/// What a search for any lane graph of a scene found out.
struct LaneGraphSearchResult {
    bool complete = false;             ///< every lane graph was looked at, or one was found
    std::optional<LaneGraph> witness;  ///< a lane graph that the checker accepts
};

/// Looks for a lane graph, whatever it costs, by the checker alone: it is asked which edges and which pairs
/// of edges can be part of one, and has the last word on every pair of paths. Shares no code with the
/// builders of problem and program and none with a solver, so that it may judge both. The time grows
/// exponentially with the cones; about 12 nearest ones take milliseconds.
[[nodiscard]] LaneGraphSearchResult search_lane_graph(const Scene& scene, const RldParameters& parameters,
                                                      double time_limit_ms);

}  // namespace conelane
