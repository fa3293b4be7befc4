// The exact solver path-pair on scenes and parameters made of the bytes, with tight limits: the independent
// checker confirms its claims, and for small scenes, so does the enumeration of every pair of paths.

#include "conelane/check.hpp"
#include "conelane/core_solvers.hpp"
#include "conelane/solve_scene.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"
#include "tests/fuzz/expectations.hpp"
#include "tests/fuzz/fuzzed_scene.hpp"

namespace conelane::fuzz {
namespace {

using Paths = std::vector<std::vector<std::size_t>>;

void require_contract(const Scene& scene, const RldParameters& parameters, const RldReport& report) {
    require(report.status != SolveStatus::error, report.message);
    const bool has_answer = report.status == SolveStatus::optimal || report.status == SolveStatus::feasible;
    require(report.lane_graph.has_value() == has_answer, "a lane graph comes with optimal and feasible");
    require(report.objective.has_value() == has_answer, "and so does its objective");
    if (report.status == SolveStatus::optimal || report.status == SolveStatus::infeasible) {
        require(!report.stopped_by, "a search that was stopped proves nothing");
    }
    if (!has_answer) return;
    // Beyond every map, the checker's different arithmetic has different rounding errors.
    if (!is_on_a_map(scene)) {
        require(paths(*report.lane_graph, scene.cones.size()).value_or(Paths{}).size() == 2, "two paths");
        return;
    }
    const CheckReport verdict = check(
        scene, parameters, *report.lane_graph,
        Claim{report.status == SolveStatus::optimal, *report.objective, report.bound, /*absolute_gap=*/1e-6});
    require(verdict.violations.empty(), verdict.violations.empty() ? "" : verdict.violations.front());
}

void solve_on(FuzzedDataProvider& input) {
    static const std::unique_ptr<RldSolver> path_pair = make_path_pair_solver();
    static const std::unique_ptr<RldSolver> exhaustive = core_solvers()[1].make(Formulation::tight);
    constexpr double kLimits_ms[]{0.0, 0.2, 0.5, 1.0, 2.0, 5.0, 20.0};
    constexpr std::size_t kFewCones = 7;
    SolveLimits limits{.time_limit_ms = input.PickValueInArray(kLimits_ms)};
    const RldParameters parameters = fuzzed_parameters(input);
    const Scene scene = fuzzed_scene(input, 40);
    const SolvedScene solved = solve_scene(*path_pair, scene, parameters, {.limits = limits});
    require_contract(scene, parameters, solved.report);

    // A start: its own answer, or edges from the bytes, possibly of cones that do not exist.
    LaneGraph start = solved.report.lane_graph.value_or(LaneGraph{});
    if (input.ConsumeBool()) {
        start.edges.clear();
        while (input.remaining_bytes() > 1 && start.edges.size() < 40) {
            start.edges.push_back(
                {input.ConsumeIntegral<std::uint8_t>(), input.ConsumeIntegral<std::uint8_t>()});
        }
    }
    const RldReport started =
        solve_scene(*path_pair, scene, parameters, {.limits = limits, .start = &start}).report;
    require_contract(scene, parameters, started);
    if (started.objective && solved.report.status == SolveStatus::optimal) {
        require(*started.objective >=
                    *solved.report.objective - 1e-6 * std::max(1.0, std::abs(*started.objective)),
                "a start does not make the optimum cheaper");
    }
    require(started.status != SolveStatus::infeasible || !solved.report.lane_graph, "infeasible is proven");

    if (scene.cones.size() > kFewCones || !is_on_a_map(scene)) return;
    const RldReport all = solve_scene(*exhaustive, scene, parameters, {}).report;
    require_contract(scene, parameters, all);
    const bool has_lane_graph = all.status == SolveStatus::optimal;
    if (solved.report.status == SolveStatus::infeasible) {
        require(!has_lane_graph, "infeasible is proven");
    }
    if (solved.report.status == SolveStatus::optimal) {
        require(has_lane_graph, "a lane graph that was found exists");
        const double scale = std::max(1.0, std::abs(*all.objective));
        require(std::abs(*solved.report.objective - *all.objective) <= 1e-6 * scale,
                "the optimum is the optimum");
    }
}

}  // namespace
}  // namespace conelane::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    FuzzedDataProvider input(data, size);
    conelane::fuzz::solve_on(input);
    return 0;
}
