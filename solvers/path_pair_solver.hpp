#pragma once

#include "conelane/bound_certificate.hpp"
#include "conelane/rld_solver.hpp"
#include "model/search_certificate.hpp"

#include <limits>
#include <memory>

namespace conelane {

/// Stages of `path-pair`. The answer is the same with each of them off; it takes longer.
struct PathPairOptions {
    bool fix_arcs = true;            ///< drop arcs whose reduced-cost bound reaches the incumbent
    bool clique_multipliers = true;  ///< multipliers on cliques of incompatible edges, not on cones alone
    bool complete_walks = true;      ///< complete the relaxation's walks to incumbents
    bool search_windows = true;      ///< improve incumbents in small parts of a large graph
    bool search_fronts = true;       ///< end nodes by the search on fronts, not by branching to the last edge
    bool drop_dominated_edges = true;  ///< there, drop what every way up to a front, or on, excludes
    int root_steps = 150;              ///< most ascent steps at the root
    int node_steps = 30;               ///< and at each other node
};

/// Exact branch and bound on the problem itself: see solvers/path_pair/exact-search.md. The instance owns its
/// workspace and reuses it from call to call. A gap below 1e-10 counts as 1e-10.
[[nodiscard]] std::unique_ptr<RldSolver> make_path_pair_solver(const PathPairOptions& options = {});

/// Multipliers and cliques that prove a lower bound for the pairing near_far, for `verify_bound`. They are
/// the root's. The multipliers alone carry this bound, so it may be below the solver's own.
[[nodiscard]] BoundCertificate certify_root_bound(
    const LaneGraphProblem& problem, double time_limit_ms = std::numeric_limits<double>::infinity());

/// Solves the problem and says how the proof can be repeated without this solver. Where the limit strikes
/// first the certificate is for the bound that was proven until then; minus infinity where there was none.
[[nodiscard]] SearchCertificate certify_search(
    const LaneGraphProblem& problem, double time_limit_ms = std::numeric_limits<double>::infinity());

}  // namespace conelane
