#include "experiments/studies/timed_call.hpp"

#include "conelane/invalid_input.hpp"
#include "conelane/solve_scene.hpp"
#include "experiments/methods/method.hpp"
#include "solvers/registry.hpp"

#include <memory>

namespace conelane::experiments {
namespace {

TimedCall call_of(const DetectorRecipe& known) {
    const std::shared_ptr<LaneDetector> detector = make_detector(known);
    return {std::string(known.name), [detector](const Scene& scene, double time_limit_ms) {
                const LaneAnswer answer = detector->detect(scene, {.time_limit_ms = time_limit_ms});
                if (answer.status == LaneStatus::error) throw InvalidInput(scene.id, answer.message);
            }};
}

TimedCall call_of(const RldSolverEntry& entry) {
    const std::shared_ptr<RldSolver> solver = entry.make(Formulation::tight);
    // For a relaxation that finds no lane, an error is a valid answer.
    const bool may_fail = !entry.has(SolverTrait::exact);
    return {std::string(entry.name), [solver, may_fail](const Scene& scene, double time_limit_ms) {
                const RldReport report = solve_scene(*solver, scene, {}, {.limits = {time_limit_ms}}).report;
                if (report.status == SolveStatus::error && !may_fail)
                    throw InvalidInput(scene.id, report.message);
            }};
}

}  // namespace

std::vector<TimedCall> timed_calls(std::span<const std::string> names) {
    std::vector<TimedCall> calls;
    for (const std::string& name : names) {
        const Method* const method = known_method(name);
        const RldSolverEntry* const solver = find_rld_solver(name);
        if (method != nullptr) {
            calls.push_back(call_of(*method->recipe));
        } else if (solver != nullptr) {
            calls.push_back(call_of(*solver));
        } else {
            throw InvalidInput("--methods", "there is no method and no solver '" + name + "'");
        }
    }
    return calls;
}

}  // namespace conelane::experiments
