#pragma once

#include "conelane/lane_graph.hpp"
#include "conelane/rld_parameters.hpp"

namespace conelane {

/// The result of a search for any lane graph of a scene.
struct LaneGraphSearchResult {
    bool complete = false;             ///< every lane graph was considered, or one was found
    std::optional<LaneGraph> witness;  ///< a lane graph that the checker accepts
};

/// Looks for a lane graph of any cost, by the checker: it decides which edges and pairs of edges may be part
/// of one, and judges every pair of paths. Shares no code with the builders of problem and program or with a
/// solver, so it can judge both. The time grows exponentially with the cones; about 12 cones take
/// milliseconds.
[[nodiscard]] LaneGraphSearchResult search_lane_graph(const Scene& scene, const RldParameters& parameters,
                                                      double time_limit_ms);

}  // namespace conelane
