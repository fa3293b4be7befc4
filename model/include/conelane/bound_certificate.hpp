#pragma once

#include "conelane/lane_graph.hpp"
#include "conelane/rld_parameters.hpp"
#include "conelane/scene.hpp"

#include <optional>
#include <string>
#include <vector>

namespace conelane {

/// Lagrange multipliers that prove a lower bound of the objective, (29) and all costs that parameters add,
/// for the pairing near_far. Every lane graph visits each cone at most once, holds at most one edge of each
/// clique and at least two edges along the heading (9). So with non-negative multipliers m,
///     cost >= cost + sum_v m_v (visits_v - 1) + sum_q m_q (edges_q - 1) + m_h (2 - along_heading),
/// and the right-hand side is a constant plus the costs of two walks, each from a near to a far cone.
struct BoundCertificate {
    struct Clique {
        std::vector<Edge> edges;  ///< any two exclude each other: (7), (28), theta_gap or a crossing
        double multiplier;
    };
    std::vector<double> cone_multiplier;  ///< by cone of the scene
    std::vector<Clique> cliques;
    double heading_multiplier = 0.0;
    double bound = 0.0;  ///< the claimed lower bound
};

struct BoundVerdict {
    std::vector<std::string> violations;  ///< a sentence each; empty if the claim holds
    std::optional<double> bound;          ///< proven; infinite: no lane graph exists; absent: no valid proof
};

/// Recomputes the bound from scene and parameters, by its own shortest walks; shares no code with any solver.
/// The claimed bound may exceed the recomputed one by at most 1e-6.
[[nodiscard]] BoundVerdict verify_bound(const Scene& scene, const RldParameters& parameters,
                                        const BoundCertificate& certificate);

}  // namespace conelane
