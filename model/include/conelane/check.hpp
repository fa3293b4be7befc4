#pragma once

#include "conelane/lane_graph.hpp"
#include "conelane/rld_parameters.hpp"
#include "conelane/scene.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace conelane {

/// The checker's result for a set of edges.
struct CheckReport {
    std::vector<std::string>
        violations;  ///< a sentence each, naming constraint and cones; empty for a lane graph
    std::optional<double> objective;  ///< (29), if every edge joins two cones of the scene
    std::size_t along_heading = 0;    ///< edges that count in (9)
    /// Whether there is a violation that more edges cannot repair: of (2), (5), (6), (27), (28), a crossing
    /// or an invalid edge.
    bool is_final = false;
};

/// Recomputes every constraint of the model and the objective from the scene alone. Shares no code with the
/// builders of problem and program. A value that exceeds its limit by at most 1e-9 keeps it.
[[nodiscard]] CheckReport check(const Scene& scene, const RldParameters& parameters, const LaneGraph& graph);

/// What a solver claims about a lane graph.
struct Claim {
    bool optimal;
    double objective;
    std::optional<double> bound;
    double absolute_gap = 1e-6;
};

/// The same, and whether the claimed objective is the recomputed one within 1e-6, whether the bound is not
/// above the objective, and whether an optimal claim has a bound within the gap.
[[nodiscard]] CheckReport check(const Scene& scene, const RldParameters& parameters, const LaneGraph& graph,
                                const Claim& claim);

}  // namespace conelane
