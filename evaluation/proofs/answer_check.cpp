#include "evaluation/proofs/answer_check.hpp"

#include "conelane/check.hpp"
#include "evaluation/world/ground_truth.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
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

}  // namespace conelane
