#include "evaluation/proofs/answer_check.hpp"

#include "conelane/bound_certificate.hpp"
#include "conelane/check.hpp"
#include "conelane/lane_graph_problem.hpp"
#include "conelane/solve_scene.hpp"
#include "evaluation/proofs/certificate_verifier.hpp"
#include "evaluation/proofs/lane_graph_search.hpp"
#include "evaluation/world/ground_truth.hpp"
#include "model/deadline.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"
#include "solvers/registry.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace conelane {
namespace {

/// The fault of a lane that was found, in words; empty if there is none.
std::string objection(const LaneRecord& record, const Scene& seen, RldParameters parameters) {
    const LaneAnswer& answer = record.answer;
    const SolvedLane solved = answer.solved.value_or(SolvedLane{answer.lane, answer.optimality});
    if (solved.d_near_m) {
        if (answer.optimality || solved.optimality)
            return "the lane is optimal for another d_near than that of the parameters";
        parameters.d_near = *solved.d_near_m;
    }
    const std::optional<LaneGraph> graph = lane_graph_of(solved.lane, seen);
    if (!graph) return "the lane has a cone that the method was not given, or one twice in a row";
    const bool is_cut = answer.solved && (!solved.d_near_m || solved.lane != answer.lane);
    if (is_cut && (!record.nearest ||
                   cut_to_nearest(solved.lane, seen, *record.nearest, parameters.d_max) != answer.lane)) {
        return "the lane is not what the cut to its cone set leaves";
    }
    CheckReport report;
    if (const auto& optimality = solved.optimality) {
        Claim claim{optimality->optimal, optimality->objective, {}};
        if (std::isfinite(optimality->bound)) claim.bound = optimality->bound;
        report = check(seen, parameters, *graph, claim);
    } else {
        report = check(seen, parameters, *graph);
    }
    return report.violations.empty() ? "" : report.violations.front();
}

using Kind = ClaimVerdict::Kind;

/// Limit of the search by the checker alone, which may take too long [ms].
constexpr double kOwnSearch_ms = 5'000.0;
/// Steps in which the proof of a whole search is repeated; seconds at most.
constexpr std::int64_t kMostSteps = 5'000'000;
constexpr std::string_view kPathPair = "path-pair";

/// A claim, with what is needed to judge it.
struct BoundClaim {
    const Scene& scene;
    const RldParameters& parameters;
    double bound;

    [[nodiscard]] bool is_infeasibility() const { return std::isinf(bound) && bound > 0.0; }
    [[nodiscard]] double tolerance() const {
        return is_infeasibility() ? 0.0 : 1e-6 * std::max(1.0, std::abs(bound));
    }
    [[nodiscard]] bool follows_from(double proven) const { return proven >= bound - tolerance(); }
    /// Colors change costs only, so they do not matter for infeasibility.
    [[nodiscard]] RldParameters costs() const {
        RldParameters of_claim = parameters;
        if (is_infeasibility()) of_claim.w_color = 0.0;
        return of_claim;
    }
};

/// Multipliers exist only for the pairing near_far.
bool multipliers_prove(const BoundClaim& claim, double time_limit_ms) {
    if (claim.parameters.pairing != Pairing::near_far) return false;
    const RldParameters parameters = claim.costs();
    const BoundCertificate certificate =
        certify_root_bound(make_problem(claim.scene, parameters), time_limit_ms);
    return claim.follows_from(certificate.bound) &&
           verify_bound(claim.scene, parameters, certificate).violations.empty();
}

bool certificate_proves(const BoundClaim& claim, double time_limit_ms) {
    const RldParameters parameters = claim.costs();
    const SearchCertificate certificate =
        certify_search(make_problem(claim.scene, parameters), time_limit_ms);
    return claim.follows_from(certificate.bound) &&
           verify_search(claim.scene, parameters, certificate, kMostSteps).kind ==
               SearchVerdict::Kind::verified;
}

/// An exact solver for problems of any size that is not the claimant; the pair search first, as the fastest.
const RldSolverEntry* other_solver(std::string_view claimant) {
    const RldSolverEntry* const pair_search = find_rld_solver(kPathPair);
    if (pair_search != nullptr && claimant != pair_search->name) return pair_search;
    const auto entry = std::ranges::find_if(rld_solvers(), [&](const RldSolverEntry& solver) {
        return solver.has(SolverTrait::exact) && solver.has(SolverTrait::uses_formulation) &&
               solver.name != claimant;
    });
    return entry == rld_solvers().end() ? nullptr : &*entry;
}

ClaimVerdict ask_solver(const RldSolverEntry& entry, const BoundClaim& claim, double time_limit_ms) {
    const std::unique_ptr<RldSolver> solver = entry.make(Formulation::tight);
    const RldReport report =
        solve_scene(*solver, claim.scene, claim.parameters, {.limits = {.time_limit_ms = time_limit_ms}})
            .report;
    ClaimVerdict verdict{Kind::unverified, std::string(entry.name), {}, {}};
    if (report.status == SolveStatus::infeasible) verdict.kind = Kind::proven;
    if (report.bound && claim.follows_from(*report.bound)) verdict.kind = Kind::proven;
    if (!report.lane_graph) return verdict;
    const CheckReport checked = check(claim.scene, claim.parameters, *report.lane_graph);
    if (!checked.violations.empty() || claim.follows_from(checked.objective.value())) return verdict;
    return {Kind::wrong, std::string(entry.name), report.lane_graph, checked.objective};
}

}  // namespace

std::optional<LaneGraph> lane_graph_of(const Lane& lane, const Scene& scene) {
    const auto index_of = index_by_id(scene);
    LaneGraph graph;
    for (const std::vector<ConeId>* boundary : {&lane.left, &lane.right}) {
        std::vector<std::size_t> path;
        for (const ConeId id : *boundary) {
            const auto index = index_of.find(id);
            if (index == index_of.end()) return std::nullopt;
            path.push_back(index->second);
        }
        if (lane.closed && !path.empty()) path.push_back(path.front());
        for (std::size_t i = 1; i < path.size(); ++i) {
            if (path[i - 1] == path[i]) return std::nullopt;
            graph.edges.push_back(make_edge(path[i - 1], path[i]));
        }
    }
    std::ranges::sort(graph.edges);
    return graph;
}

void check_answer(LaneRecord& record, const Scene& seen, const RldParameters& parameters) {
    if (record.answer.status != LaneStatus::found) return;
    const std::string found = objection(record, seen, parameters);
    if (found.empty()) {
        record.checked = true;
        return;
    }
    LaneAnswer rejected;
    rejected.status = LaneStatus::error;
    rejected.message = "rejected by the checker: " + found;
    record.answer = std::move(rejected);
}

ClaimVerdict judge_bound(const Scene& scene, const RldParameters& parameters, double bound,
                         std::string_view claimant, double time_limit_ms) {
    const Deadline deadline(time_limit_ms);
    const BoundClaim claim{scene, parameters, bound};
    if (claim.is_infeasibility()) {
        LaneGraphSearchResult search =
            search_lane_graph(scene, parameters, std::min(time_limit_ms / 3.0, kOwnSearch_ms));
        const std::string by = "the checker's own search";
        if (search.witness) {
            const std::optional<double> objective = check(scene, parameters, *search.witness).objective;
            return {Kind::wrong, by, std::move(search.witness), objective};
        }
        if (search.complete) return {Kind::proven, by, {}, {}};
    }
    if (multipliers_prove(claim, deadline.remaining_ms() / 2.0)) return {Kind::proven, "multipliers", {}, {}};
    if (claimant == kPathPair && certificate_proves(claim, deadline.remaining_ms() / 2.0))
        return {Kind::proven, "a certificate of the whole search", {}, {}};
    const RldSolverEntry* const solver = other_solver(claimant);
    if (solver == nullptr) return {};
    return ask_solver(*solver, claim, deadline.remaining_ms());
}

}  // namespace conelane
