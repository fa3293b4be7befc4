#include "conelane/solve_scene.hpp"

#include "detectors/solve_valid_scene.hpp"
#include "model/deadline.hpp"
#include "model/valid_scene_problem.hpp"

#include <exception>
#include <new>
#include <utility>

namespace conelane {
namespace {

using MakeProblem = LimitedProblem (*)(const Scene&, const RldParameters&, EdgeExtent, const Deadline&);

SolvedScene solve(RldSolver& solver, const Scene& scene, const RldParameters& parameters,
                  SolveArguments arguments, MakeProblem make_problem_of) {
    const Stopwatch watch;
    const Deadline deadline(arguments.limits.time_limit_ms);
    SolvedScene solved;
    try {
        LimitedProblem made = make_problem_of(scene, parameters, solver.extent(), deadline);
        const double problem_ms = watch.elapsed_ms();
        if (made.problem) {
            solved.problem = *std::move(made.problem);
            arguments.limits.time_limit_ms = deadline.remaining_ms();
            solved.report = solver.solve(solved.problem, arguments);
        } else {
            solved.report.status = SolveStatus::stopped;
            solved.report.stopped_by = made.stopped_by;
        }
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

}  // namespace

SolvedScene solve_scene(RldSolver& solver, const Scene& scene, const RldParameters& parameters,
                        const SolveArguments& arguments) {
    return solve(solver, scene, parameters, arguments, make_problem);
}

SolvedScene solve_valid_scene(RldSolver& solver, const Scene& scene, const RldParameters& parameters,
                              const SolveArguments& arguments) {
    return solve(solver, scene, parameters, arguments, make_problem_of_valid_scene);
}

}  // namespace conelane
