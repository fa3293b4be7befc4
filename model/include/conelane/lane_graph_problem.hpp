#pragma once

#include "conelane/lane_graph.hpp"
#include "conelane/rld_parameters.hpp"
#include "conelane/scene.hpp"
#include "conelane/stop_reason.hpp"

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace conelane {

class Deadline;  // internal

/// Smallest distance [m] of the car to an edge's midpoint in (25), because the cost has a pole at 0.
inline constexpr double kMinCarDistance_m = 0.5;

/// An edge of the problem and its numbers. Cone indices i < j.
struct ProblemEdge {
    std::size_t i;
    std::size_t j;
    double spacing_cost;  ///< s_ij (18), without weight
    double heading_cost;  ///< p_ij (25), without weight
    /// 1 if one cone is blue and the other yellow, plus 1 if an edge along the heading is on the wrong side:
    /// to the right of the car with a blue cone, or to the left with a yellow one. An edge is to the right if
    /// its midpoint is to the right of the car's axis and the car is to the left of the edge's line, directed
    /// along the heading; to the left likewise. In a bend the two tests may differ: then the edge is on no
    /// side. Other edges have no side.
    double color_cost;
    double facing_cost;  ///< v_ij, see facing_costs; 0 if w_v is 0 and no costs are learned
    /// w_s s_ij + w_p p_ij - w_b (29), with use_confidence - w_b times both cones' confidences instead, and
    /// of the extras w_color color_ij + w_v v_ij - w_n (z_i + z_j), and of learned costs its own and those of
    /// ends at i and at j.
    double cost;
    bool along_heading;         ///< h_ij of (9)
    bool high_cost;             ///< never chosen: s_ij > s_crit (27) and no gap, or excluded by k_edge
    bool gap = false;           ///< s_ij > s_crit, but d_gap allows it over a gap
    double learned_cost = 0.0;  ///< of the edge alone; 0 if it is high_cost
};

/// Two edges that meet in a cone, {i, middle} and {middle, k} with i < k, as indices into `edges`.
struct ProblemTurn {
    std::size_t edge_i;
    std::size_t edge_k;
    std::size_t middle;
    double angle_cost;  ///< t_ijk (20), without weight
    double unevenness;  ///< u_ijk, without weight; 0 if w_u is 0
    double cost;     ///< w_t t_ijk, of the extras w_u u_ijk + 2 w_n z_j, and of learned costs; not negative
    bool high_cost;  ///< edges never chosen together: t_ijk > t_crit (28), or too sharp at a gap
    double learned_cost = 0.0;  ///< of the turn alone, not negative; 0 if it or an edge is high_cost
};

/// Which edges a problem lists.
enum class EdgeExtent {
    candidates,  ///< those that (27) and k_edge allow
    all_pairs,   ///< all n (n - 1) / 2, as the printed model has them
};

/// The numbers of one scene. All geometry is evaluated when it is made. Edges are in the paper's order
/// (column-major lower triangle); an edge of zero length is high-cost for any spacing cost.
struct LaneGraphProblem {
    std::size_t cone_count = 0;
    RldParameters parameters;
    std::vector<ProblemEdge> edges;
    std::vector<ProblemTurn> turns;  ///< all pairs of listed edges that share a cone, by middle cone
    std::vector<std::pair<std::size_t, std::size_t>> conflicts;  ///< (6)-(8): edges too close, first < second
    std::vector<bool> near;                                      ///< r_i of (11)
    /// All edges within s_crit, also those that k_edge excludes: they may face another edge, see
    /// facing_costs. Empty if no cost needs them.
    std::vector<Edge> facers;
    /// z_i of formulation.md; 0 for a far cone. A path ends at i where m_i = A_i - 2 (turns at i) is 1, else
    /// m_i is 0. So - w_n sum_i z_i m_i is a cost of edges and turns, and solvers need no term for it.
    std::vector<double> near_end_fit;
    /// By cone: the learned cost if a path ends there, at most 0; in the same way a cost of edges and turns.
    std::vector<double> learned_end_cost;
    std::vector<std::pair<std::size_t, std::size_t>> far_apart;  ///< (17): far cones i < j with D_ij > d_max
    std::vector<std::vector<double>> distance_m;                 ///< D_ij; filled for all_pairs only
    std::vector<std::vector<std::size_t>> incident;              ///< edges at each cone, ascending
};

/// Throws InvalidInput if the scene or the parameters are not valid. No time or memory limit:
/// both grow with the fourth power of the cones where many lie within reach of each other.
[[nodiscard]] LaneGraphProblem make_problem(const Scene& scene, const RldParameters& parameters,
                                            EdgeExtent extent = EdgeExtent::candidates);

/// A problem with more edges is not solved, because the memory of solvers grows with their square. Scenes of
/// a car are smaller: 234 cones within 50 m, half of them false, give a tenth of these edges.
inline constexpr std::size_t kMaxProblemEdges = 16'384;
/// Largest number of turns, conflicts and far-apart pairs together, below 256 MB.
inline constexpr std::size_t kMaxProblemEntries = 4'000'000;
[[nodiscard]] bool is_too_large(const LaneGraphProblem& problem);

/// A problem, or why its construction stopped.
struct LimitedProblem {
    std::optional<LaneGraphProblem> problem;  ///< complete; absent if a limit ended construction
    std::optional<StopReason> stopped_by;     ///< if absent: time or memory
};

/// The same problem as without a deadline, or none if the deadline passes (it is checked about every 0.1 ms)
/// or the problem is too large. Throws as above.
[[nodiscard]] LimitedProblem make_problem(const Scene& scene, const RldParameters& parameters,
                                          EdgeExtent extent, const Deadline& deadline);

/// Objective (29) of a lane graph: edge costs plus the costs of all turns it takes. Precondition: every edge
/// is listed in the problem.
[[nodiscard]] double objective(const LaneGraphProblem& problem, const LaneGraph& graph);

/// Whether a set of edges fulfils every constraint of the problem, with the pairing. An edge that the problem
/// does not list is not allowed.
[[nodiscard]] bool is_feasible(const LaneGraphProblem& problem, const LaneGraph& graph);

}  // namespace conelane
