#pragma once

#include "conelane/bound_certificate.hpp"
#include "conelane/rld_solver.hpp"
#include "model/search_certificate.hpp"
#include "solvers/path_pair/path_pair_options.hpp"

namespace conelane {

/// Exact branch and bound on the problem itself: see solvers/path_pair/exact-search.md. The instance owns its
/// workspace and reuses it from call to call. A gap below 1e-10 counts as 1e-10.
[[nodiscard]] std::unique_ptr<RldSolver> make_path_pair_solver(const PathPairOptions& options = {});

/// Multipliers and cliques of the root that prove a lower bound for the pairing near_far, for `verify_bound`.
/// They prove this bound without the search, so it may be below the solver's bound.
[[nodiscard]] BoundCertificate certify_root_bound(
    const LaneGraphProblem& problem, double time_limit_ms = std::numeric_limits<double>::infinity());

/// Solves the problem and returns what is needed to repeat the proof without this solver. If the limit ends
/// the search, the certificate is for the bound proven so far; minus infinity if there is none.
[[nodiscard]] SearchCertificate certify_search(
    const LaneGraphProblem& problem, double time_limit_ms = std::numeric_limits<double>::infinity());

}  // namespace conelane
