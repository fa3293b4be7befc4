#include "evaluation/checking/infeasibility.hpp"

#include "conelane/bound_certificate.hpp"
#include "conelane/check.hpp"
#include "conelane/lane_graph_problem.hpp"
#include "conelane/solve_scene.hpp"
#include "evaluation/checking/lane_graph_search.hpp"
#include "model/deadline.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"
#include "solvers/registry.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace conelane {
namespace {

using Kind = InfeasibilityVerdict::Kind;

/// Limit of the search by the checker alone, which may take too long [ms].
constexpr double kOwnSearch_ms = 5'000.0;

/// Multipliers exist only for the pairing near_far; colors change costs only, so they are switched off.
bool multipliers_prove_it(const Scene& scene, RldParameters parameters, double time_limit_ms) {
    if (parameters.pairing != Pairing::near_far) return false;
    parameters.w_color = 0.0;
    const BoundCertificate certificate = certify_root_bound(make_problem(scene, parameters), time_limit_ms);
    if (!std::isinf(certificate.bound) || certificate.bound < 0.0) return false;
    return verify_bound(scene, parameters, certificate).violations.empty();
}

/// An exact solver for problems of any size that is not the claimant; the pair search first, as the fastest.
const RldSolverEntry* other_solver(std::string_view claimant) {
    const RldSolverEntry* const pair_search = find_rld_solver("path-pair");
    if (pair_search != nullptr && claimant != pair_search->name) return pair_search;
    const auto entry = std::ranges::find_if(rld_solvers(), [&](const RldSolverEntry& solver) {
        return solver.exact && solver.uses_formulation && solver.name != claimant;
    });
    return entry == rld_solvers().end() ? nullptr : &*entry;
}

InfeasibilityVerdict ask_solver(const RldSolverEntry& entry, const Scene& scene,
                                const RldParameters& parameters, double time_limit_ms) {
    const std::unique_ptr<RldSolver> solver = entry.make(Formulation::tight);
    const RldReport report = solve_scene(*solver, scene, parameters, {.time_limit_ms = time_limit_ms}).report;
    const std::string name(entry.name);
    if (report.lane_graph && check(scene, parameters, *report.lane_graph).violations.empty()) {
        return {Kind::refuted, name, report.lane_graph};
    }
    return {report.status == SolveStatus::infeasible ? Kind::confirmed : Kind::open, name, {}};
}

}  // namespace

InfeasibilityVerdict judge_infeasible(const Scene& scene, const RldParameters& parameters,
                                      std::string_view claimant, double time_limit_ms) {
    const Deadline deadline(time_limit_ms);
    LaneGraphSearchResult search =
        search_lane_graph(scene, parameters, std::min(time_limit_ms / 3.0, kOwnSearch_ms));
    if (search.witness) return {Kind::refuted, "the checker's own search", std::move(search.witness)};
    if (search.complete) return {Kind::confirmed, "the checker's own search", {}};
    if (multipliers_prove_it(scene, parameters, deadline.remaining_ms() / 2.0)) {
        return {Kind::confirmed, "multipliers", {}};
    }
    const RldSolverEntry* const solver = other_solver(claimant);
    if (solver == nullptr) return {};
    return ask_solver(*solver, scene, parameters, deadline.remaining_ms());
}

}  // namespace conelane
