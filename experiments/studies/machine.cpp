#include "experiments/studies/machine.hpp"

#include "conelane/solve_scene.hpp"
#include "evaluation/formats/scene_set.hpp"
#include "evaluation/scoring/statistics.hpp"
#include "model/deadline.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"

#include <ctime>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace conelane::experiments {
namespace {

std::optional<std::size_t> status_bytes(std::string_view key) {
    constexpr std::size_t kKiB = 1024;
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;) {
        std::size_t kib = 0;
        if (word == key && status >> kib) return kib * kKiB;
    }
    return std::nullopt;
}

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

double thread_cpu_ms() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

PeakMemory::PeakMemory() {
#ifdef __GLIBC__
    malloc_trim(0);
#endif
    std::ofstream peak("/proc/self/clear_refs");
    peak << "5";  // resets the peak to the current value
    peak.close();
    if (peak) before_bytes_ = status_bytes("VmRSS:");
}

std::optional<std::size_t> PeakMemory::rise_bytes() const {
    const auto peak = status_bytes("VmHWM:");
    if (!before_bytes_ || !peak) return std::nullopt;
    return *peak > *before_bytes_ ? *peak - *before_bytes_ : 0;
}

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
