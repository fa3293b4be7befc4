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

/// (25) takes a smaller distance [m] of the car to an edge's midpoint as this: the cost has a pole at 0.
inline constexpr double kMinCarDistance_m = 0.5;

/// An edge of the problem and its numbers. Cone indices i < j.
struct ProblemEdge {
    std::size_t i;
    std::size_t j;
    double spacing_cost;  ///< s_ij (18), without weight
    double heading_cost;  ///< p_ij (25), without weight
    /// 1 if one cone is blue and the other yellow, plus 1 if an edge along the heading (h_ij) is to the right
    /// of the car and has a blue cone, or to its left and has a yellow one; with class probabilities the
    /// expected value. An edge is to the right if its midpoint is right of the car's axis and the car is left
    /// of the edge's line, directed along the heading; to the left with both sides swapped. If the two tests
    /// differ, as in a bend, it is on neither side.
    double color_cost;
    double facing_cost;  ///< v_ij, without weight; 0 if w_v is 0 and no costs are learned
    /// w_s s_ij + w_p p_ij - w_b (29), where use_confidence multiplies w_b by both cones' confidences. The
    /// extras add w_color color_ij + w_v v_ij - w_n (z_i + z_j). Learned costs add learned_cost and the
    /// learned_end_cost of i and of j.
    double cost;
    bool along_heading;         ///< h_ij of (9)
    bool high_cost;             ///< forbidden: by (27) unless `gap`, by k_edge, or shorter than 1e-100 m
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
    double cost;        ///< w_t t_ijk + w_u u_ijk + 2 w_n z_j + learned_cost - 2 learned_end_cost of j; >= 0
    bool high_cost;     ///< forbidden: t_ijk > t_crit (28), or more than theta_gap at a gap
    double learned_cost = 0.0;  ///< of the turn alone, not negative; 0 if it or an edge is high_cost
};

/// Which edges a problem lists.
enum class EdgeExtent {
    candidates,  ///< those that may be chosen: no ProblemEdge::high_cost
    all_pairs,   ///< all n (n - 1) / 2, as the printed model has them
};

/// The numbers of one scene. All geometry is evaluated when it is made. Edges are ordered by i, then by j
/// (the paper's column-major lower triangle).
struct LaneGraphProblem {
    std::size_t cone_count = 0;
    RldParameters parameters;
    std::vector<ProblemEdge> edges;
    std::vector<ProblemTurn> turns;  ///< all pairs of listed edges that share a cone, by middle cone
    std::vector<std::pair<std::size_t, std::size_t>> conflicts;  ///< first < second: (6)-(8), or crossing
    std::vector<bool> near;                                      ///< r_i of (11), with d_side
    /// Edges among which v_ij looks for a facing edge: all within s_crit, also those that k_edge excludes.
    /// Empty if no cost needs them.
    std::vector<Edge> facers;
    /// z_i of formulation.md; 0 for a far cone, and if w_n is 0. m_i = degree - 2 (turns at i) is 1 if a path
    /// ends at i, else 0. So the costs of edges and turns include (-w_n) sum_i z_i m_i.
    std::vector<double> near_end_fit;
    /// By cone: the learned cost if a path ends there, at most 0. It is a cost of edges and turns likewise.
    std::vector<double> learned_end_cost;
    std::vector<std::pair<std::size_t, std::size_t>> far_apart;  ///< (17): far cones i < j with D_ij > d_max
    std::vector<std::vector<double>> distance_m;                 ///< D_ij; filled for all_pairs only
    std::vector<std::vector<std::size_t>> incident;              ///< edges at each cone, ascending
};

/// Throws InvalidInput if the scene or the parameters are not valid. No limit of time or memory: both grow
/// with the fourth power of the number of cones where many lie within reach of each other.
[[nodiscard]] LaneGraphProblem make_problem(const Scene& scene, const RldParameters& parameters,
                                            EdgeExtent extent = EdgeExtent::candidates);

/// A problem with more edges is not solved, because the memory of solvers grows with their square. Scenes of
/// a car are smaller: 234 cones within 50 m, half of them false, give a tenth of these edges.
inline constexpr std::size_t kMaxProblemEdges = 16'384;
/// Largest number of turns, conflicts and far-apart pairs together, at most 256 MB.
inline constexpr std::size_t kMaxProblemEntries = 4'000'000;
[[nodiscard]] bool is_too_large(const LaneGraphProblem& problem);

/// A problem, or why its construction stopped.
struct LimitedProblem {
    std::optional<LaneGraphProblem> problem;  ///< absent if a limit ended its construction
    std::optional<StopReason> stopped_by;     ///< time or memory; absent if there is a problem
};

/// The same problem as without a deadline, or none if the deadline passes (it is checked about every 0.1 ms)
/// or the problem is too large. Throws as above.
[[nodiscard]] LimitedProblem make_problem(const Scene& scene, const RldParameters& parameters,
                                          EdgeExtent extent, const Deadline& deadline);

/// Objective (29) with the costs that parameters add: ProblemEdge::cost of its edges plus ProblemTurn::cost
/// of its turns. Precondition: the edges are in ascending order and listed in the problem.
[[nodiscard]] double objective(const LaneGraphProblem& problem, const LaneGraph& graph);

/// Whether a set of edges fulfils every constraint of the problem, with the pairing. An edge that the problem
/// does not list is not allowed. Precondition: the edges are in ascending order.
[[nodiscard]] bool is_feasible(const LaneGraphProblem& problem, const LaneGraph& graph);

}  // namespace conelane
