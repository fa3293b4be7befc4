#include "experiments/studies/reference_problem.hpp"

#include "conelane/solve_scene.hpp"
#include "evaluation/scenes/scene_set.hpp"
#include "evaluation/scoring/statistics.hpp"
#include "model/deadline.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"

#include <vector>

namespace conelane::experiments {
namespace {

Scene reference_scene() {
    SceneOptions options;
    options.false_positive_rates = {0.3};
    options.ranges_m = {30.0};
    options.every_m = 1000.0;
    options.seed = 1;
    constexpr std::size_t kCones = 16;
    return nearest_ahead(make_scene_set({"generated:kidney"}, options).scenes.at(0).scene, kCones);
}

}  // namespace

ReferenceProblem::ReferenceProblem() : scene_(reference_scene()), solver_(make_path_pair_solver()) {}

double ReferenceProblem::median_ms() {
    constexpr double kEnough_ms = 50.0;
    constexpr std::size_t kWarmUps = 3;
    for (std::size_t k = 0; k < kWarmUps; ++k) (void)solve_scene(*solver_, scene_, {}, {});
    std::vector<double> times_ms;
    const Stopwatch watch;
    while (times_ms.size() < kWarmUps || watch.elapsed_ms() < kEnough_ms)
        times_ms.push_back(solve_scene(*solver_, scene_, {}, {}).total_ms);
    return median(times_ms);
}

double coefficient_of_variation(std::span<const double> values) {
    return values.size() < 2 ? 0.0 : standard_deviation(values) / mean(values);
}

}  // namespace conelane::experiments
