#include "detectors/solve_scene.hpp"

#include "model/deadline.hpp"

#include <exception>
#include <new>

namespace conelane {

SolvedScene solve_scene(RldSolver& solver, const Scene& scene, const RldParameters& parameters,
                        const SolveLimits& limits, const LaneGraph* start) {
    const Stopwatch watch;
    const Deadline deadline(limits.time_limit_ms);
    SolvedScene solved;
    try {
        solved.problem = make_problem(scene, parameters, solver.extent());
        const double problem_ms = watch.elapsed_ms();
        solved.report = solver.solve(solved.problem, {deadline.remaining_ms(), limits.absolute_gap}, start);
        solved.report.build_ms += problem_ms;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& failure) {
        solved.report = {};
        solved.report.message = failure.what();
    }
    solved.total_ms = watch.elapsed_ms();
    return solved;
}

}  // namespace conelane
