#include "experiments/tuning/failure_causes.hpp"

#include "conelane/lane_graph_problem.hpp"
#include "evaluation/proofs/answer_check.hpp"
#include "evaluation/scoring/score.hpp"
#include "evaluation/world/ground_truth.hpp"
#include "experiments/tuning/weight_fit.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

namespace conelane::experiments {
namespace {

/// The first family of constraints that the ground truth violates.
FailureCause broken_constraint(const LaneGraphProblem& problem, const LaneGraph& graph) {
    std::vector<bool> chosen(problem.edges.size(), false);
    std::size_t listed = 0;
    std::size_t along_heading = 0;
    for (std::size_t e = 0; e < problem.edges.size(); ++e) {
        const ProblemEdge& edge = problem.edges[e];
        chosen[e] = !edge.high_cost && std::ranges::binary_search(graph.edges, Edge{edge.i, edge.j});
        if (!chosen[e]) continue;
        ++listed;
        if (edge.along_heading) ++along_heading;
    }
    if (listed != graph.edges.size()) return FailureCause::breaks_spacing;
    const bool too_sharp = std::ranges::any_of(problem.turns, [&](const ProblemTurn& turn) {
        return turn.high_cost && chosen[turn.edge_i] && chosen[turn.edge_k];
    });
    if (too_sharp) return FailureCause::breaks_angle;
    const bool too_close = std::ranges::any_of(problem.conflicts, [&](const auto& conflict) {
        return chosen[conflict.first] && chosen[conflict.second];
    });
    if (too_close) return FailureCause::breaks_width;
    return along_heading < 2 ? FailureCause::breaks_heading : FailureCause::breaks_endpoints;
}

/// The term in which the ground truth costs most above the answer.
FailureCause most_expensive_term(const LaneGraphProblem& problem, const LaneGraph& ground_truth,
                                 const LaneGraph& answer) {
    constexpr std::array<FailureCause, kObjectiveTermCount> kCheaper{
        FailureCause::cheaper_benefit, FailureCause::cheaper_spacing,  FailureCause::cheaper_angle,
        FailureCause::cheaper_heading, FailureCause::cheaper_color,    FailureCause::cheaper_unevenness,
        FailureCause::cheaper_facing,  FailureCause::cheaper_near_ends};
    const ObjectiveSums theirs = objective_sums(problem, ground_truth);
    const ObjectiveSums ours = objective_sums(problem, answer);
    std::size_t most_expensive = 0;
    double most = -std::numeric_limits<double>::infinity();
    for (std::size_t term = 0; term < kObjectiveTermCount; ++term) {
        const double more = problem.parameters.*kObjectiveWeights[term] * (theirs[term] - ours[term]);
        if (more <= most) continue;
        most = more;
        most_expensive = term;
    }
    return kCheaper[most_expensive];
}

bool contains(const std::vector<ConeId>& run, ConeId id) {
    return std::ranges::find(run, id) != run.end();
}

}  // namespace

std::string_view to_string(FailureCause cause) {
    constexpr std::array<std::string_view, kFailureCauseCount> kNames{
        "no_ground_truth",    "accurate",       "breaks_spacing",    "breaks_angle",
        "breaks_width",       "breaks_heading", "breaks_endpoints",  "cheaper_benefit",
        "cheaper_spacing",    "cheaper_angle",  "cheaper_heading",   "cheaper_color",
        "cheaper_unevenness", "cheaper_facing", "cheaper_near_ends", "none_found"};
    return kNames[static_cast<std::size_t>(cause)];
}

WrongCones wrong_cones(const Lane& lane, const Lane& ground_truth) {
    WrongCones wrong;
    const auto add = [&](const std::vector<ConeId>& ours, const std::vector<ConeId>& theirs) {
        const auto shared = [&](ConeId id) { return contains(ours, id) && contains(theirs, id); };
        if (std::ranges::none_of(ours, shared)) {
            wrong.on_lost_boundary += ours.size() + theirs.size();
            return;
        }
        for (const std::vector<ConeId>* run : {&ours, &theirs}) {
            const auto first = std::ranges::find_if(*run, shared);
            const auto behind_last = std::find_if(run->rbegin(), run->rend(), shared).base();
            wrong.near_end += static_cast<std::size_t>(first - run->begin());
            wrong.far_end += static_cast<std::size_t>(run->end() - behind_last);
            wrong.inside += static_cast<std::size_t>(std::count_if(first, behind_last, std::not_fn(shared)));
        }
    };
    add(lane.left, ground_truth.left);
    add(lane.right, ground_truth.right);
    return wrong;
}

Diagnosis diagnose(const AnnotatedScene& annotated, const RldParameters& parameters,
                   const EvaluationOptions& options) {
    const auto ground_truth_of = [&](std::optional<std::size_t> count) {
        return count ? ground_truth_of_nearest(annotated, *count) : annotated.ground_truth;
    };
    const std::optional<Lane> ground_truth = ground_truth_of(options.nearest);
    if (!ground_truth) return {};
    const auto solver = make_path_pair_solver();
    const EvaluatedScene evaluated = evaluate(*solver, annotated.scene, parameters, options);
    Diagnosis diagnosis;
    if (evaluated.answer.status == LaneStatus::found) {
        if (score(annotated, evaluated.answer, 0.0, options.nearest, nullptr).accurate())
            return {FailureCause::accurate, std::nullopt};
        diagnosis.wrong = wrong_cones(evaluated.answer.lane, *ground_truth);
    }
    const LaneGraphProblem& problem = evaluated.problem;
    const RldReport& report = evaluated.report;
    const LaneGraph graph = *lane_graph_of(*ground_truth_of(seen_count(options)), evaluated.seen);
    if (!is_feasible(problem, graph)) {
        diagnosis.cause = broken_constraint(problem, graph);
    } else if (!report.lane_graph || *report.objective > objective(problem, graph)) {
        diagnosis.cause = FailureCause::none_found;
    } else {
        diagnosis.cause = most_expensive_term(problem, graph, *report.lane_graph);
    }
    return diagnosis;
}

}  // namespace conelane::experiments
