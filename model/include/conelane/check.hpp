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
    std::vector<std::string> violations;  ///< a sentence each; empty for a lane graph
    /// Equation (29) with the costs that parameters add. Absent if an edge is a loop, occurs twice or has an
    /// index beyond the scene's cones.
    std::optional<double> objective;
    std::size_t along_heading = 0;  ///< edges that count in (9)
    /// Whether a violation stays if edges are added: one other than (3), (9), (11), (17) or the pairing.
    bool is_final = false;
};

/// Recomputes every constraint of the model and the objective from scene and parameters. Shares no code with
/// the builders of problem and program. A value may exceed its limit by at most 1e-9.
[[nodiscard]] CheckReport check(const Scene& scene, const RldParameters& parameters, const LaneGraph& graph);

/// What a solver claims about a lane graph.
struct Claim {
    bool optimal;
    double objective;
    std::optional<double> bound;
    double absolute_gap = 1e-6;
};

/// Also checks the claim against the recomputed objective c, to within 1e-6 max(1, |c|): its objective is c,
/// its bound is not above c, and a claimed optimum has a bound within the gap of c.
[[nodiscard]] CheckReport check(const Scene& scene, const RldParameters& parameters, const LaneGraph& graph,
                                const Claim& claim);

}  // namespace conelane
