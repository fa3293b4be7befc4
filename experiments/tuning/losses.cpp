#include "experiments/tuning/losses.hpp"

#include "experiments/scenes/ground_truth.hpp"
#include "experiments/scoring/score.hpp"
#include "model/lane_graph_problem.hpp"
#include "solvers/path_pair_solver.hpp"

#include <algorithm>
#include <unordered_map>
#include <vector>

namespace conelane::experiments {
namespace {

LaneGraph graph_of(const Lane& lane, const Scene& scene) {
    std::unordered_map<ConeId, std::size_t> index_of;
    for (std::size_t i = 0; i < scene.cones.size(); ++i) index_of.emplace(scene.cones[i].id, i);
    LaneGraph graph;
    for (const std::vector<ConeId>* side : {&lane.left, &lane.right}) {
        for (std::size_t i = 1; i < side->size(); ++i) {
            graph.edges.push_back(make_edge(index_of.at((*side)[i - 1]), index_of.at((*side)[i])));
        }
    }
    std::ranges::sort(graph.edges);
    return graph;
}

/// The first family of constraints that the ground truth breaks.
Loss broken_constraint(const LaneGraphProblem& problem, const LaneGraph& graph) {
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
    if (listed != graph.edges.size()) return Loss::spacing;
    const bool too_sharp = std::ranges::any_of(problem.turns, [&](const ProblemTurn& turn) {
        return turn.high_cost && chosen[turn.edge_i] && chosen[turn.edge_k];
    });
    if (too_sharp) return Loss::angle;
    const bool too_close = std::ranges::any_of(problem.conflicts, [&](const auto& conflict) {
        return chosen[conflict.first] && chosen[conflict.second];
    });
    if (too_close) return Loss::width;
    return along_heading < 2 ? Loss::heading : Loss::endpoints;
}

}  // namespace

std::string_view to_string(Loss loss) {
    constexpr std::array<std::string_view, kLossCount> kNames{"no_ground_truth", "accurate",    "spacing",
                                                              "angle",           "width",       "heading",
                                                              "endpoints",       "cheaper_one", "none_found"};
    return kNames[static_cast<std::size_t>(loss)];
}

Loss loss_on(const AnnotatedScene& annotated, const RldParameters& parameters,
             std::optional<std::size_t> nearest, double time_limit_ms) {
    const std::optional<Lane> ground_truth =
        nearest ? ground_truth_of_nearest(annotated, *nearest) : annotated.ground_truth;
    if (!ground_truth) return Loss::no_ground_truth;
    const Scene scene = nearest ? nearest_ahead(annotated.scene, *nearest) : annotated.scene;
    const auto solver = make_path_pair_solver();
    const LaneGraphProblem problem = make_problem(scene, parameters, solver->extent());
    const RldReport report = solver->solve(problem, {time_limit_ms});
    if (report.lane_graph) {
        LaneAnswer answer;
        if (const std::optional<Lane> lane = to_lane(*report.lane_graph, scene)) {
            answer.status = LaneStatus::found;
            answer.lane = *lane;
        }
        if (score(annotated, answer, 0.0, nearest, nullptr).accurate()) return Loss::accurate;
    }
    const LaneGraph graph = graph_of(*ground_truth, scene);
    if (!is_feasible(problem, graph)) return broken_constraint(problem, graph);
    return report.objective && *report.objective <= objective(problem, graph) ? Loss::cheaper_one
                                                                              : Loss::none_found;
}

}  // namespace conelane::experiments
