#include "experiments/studies/reference_problem.hpp"

#include "conelane/solve_scene.hpp"
#include "evaluation/formats/scene_set.hpp"
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

double ReferenceProblem::mean_ms() {
    constexpr int kSolves = 1000;
    const Stopwatch watch;
    for (int k = 0; k < kSolves; ++k) (void)solve_scene(*solver_, scene_, {}, {});
    return watch.elapsed_ms() / kSolves;
}

double coefficient_of_variation(std::span<const double> values) {
    return values.size() < 2 ? 0.0 : standard_deviation(values) / mean(values);
}

}  // namespace conelane::experiments
