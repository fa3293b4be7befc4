#include "evaluation/scoring/solver_measures.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/scoring/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace conelane {
namespace {

constexpr double kPar10 = 10.0;

/// The number of runs, which is the same for every solver.
std::size_t common_size(std::span<const std::vector<SolverRun>> by_solver) {
    const std::size_t runs = by_solver.empty() ? 0 : by_solver.front().size();
    for (const std::vector<SolverRun>& one : by_solver) {
        if (one.size() != runs) throw InvalidInput("runs", "solvers have different numbers of them");
    }
    return runs;
}

/// The solver that solves the run first.
std::optional<std::size_t> fastest(std::span<const std::vector<SolverRun>> by_solver, std::size_t run) {
    std::optional<std::size_t> best;
    for (std::size_t s = 0; s < by_solver.size(); ++s) {
        if (!by_solver[s][run].solved) continue;
        if (!best || by_solver[s][run].time_ms < by_solver[*best][run].time_ms) best = s;
    }
    return best;
}

}  // namespace

std::vector<double> penalised_times_ms(std::span<const SolverRun> runs, double limit_ms, double factor) {
    std::vector<double> times;
    times.reserve(runs.size());
    for (const SolverRun& run : runs) times.push_back(run.solved ? run.time_ms : factor * limit_ms);
    return times;
}

double penalised_average_ms(std::span<const SolverRun> runs, double limit_ms, double factor) {
    return mean(penalised_times_ms(runs, limit_ms, factor));
}

std::vector<std::vector<double>> performance_profiles(std::span<const std::vector<SolverRun>> by_solver,
                                                      std::span<const double> ratios) {
    const std::size_t runs = common_size(by_solver);
    if (runs == 0) throw InvalidInput("runs", "there is none");
    std::vector<std::vector<double>> shares(by_solver.size(), std::vector<double>(ratios.size(), 0.0));
    for (std::size_t run = 0; run < runs; ++run) {
        const auto best = fastest(by_solver, run);
        if (!best) continue;
        const double best_ms = by_solver[*best][run].time_ms;
        for (std::size_t s = 0; s < by_solver.size(); ++s) {
            if (!by_solver[s][run].solved) continue;
            for (std::size_t r = 0; r < ratios.size(); ++r) {
                if (by_solver[s][run].time_ms <= ratios[r] * best_ms) shares[s][r] += 1.0;
            }
        }
    }
    for (std::vector<double>& of_solver : shares) {
        for (double& share : of_solver) share /= static_cast<double>(runs);
    }
    return shares;
}

BestSolvers best_solvers(std::span<const std::vector<SolverRun>> by_solver, double limit_ms) {
    const std::size_t runs = common_size(by_solver);
    if (runs == 0) throw InvalidInput("runs", "there is none");
    BestSolvers best;
    best.single_par10_ms = std::numeric_limits<double>::infinity();
    for (std::size_t s = 0; s < by_solver.size(); ++s) {
        const double par10_ms = penalised_average_ms(by_solver[s], limit_ms, kPar10);
        if (par10_ms >= best.single_par10_ms) continue;
        best.single_best = s;
        best.single_par10_ms = par10_ms;
    }
    best.won.assign(by_solver.size(), 0);
    std::vector<SolverRun> chosen(runs);
    for (std::size_t run = 0; run < runs; ++run) {
        const auto winner = fastest(by_solver, run);
        if (!winner) continue;
        ++best.won[*winner];
        chosen[run] = by_solver[*winner][run];
    }
    best.virtual_par10_ms = penalised_average_ms(chosen, limit_ms, kPar10);
    return best;
}

double relative_distance(std::optional<double> a, std::optional<double> b) {
    if (!a || !b) return 1.0;
    const double largest = std::max(std::abs(*a), std::abs(*b));
    if (largest == 0.0) return 0.0;
    if (*a * *b < 0.0) return 1.0;
    return std::abs(*a - *b) / largest;
}

GapIntegrals gap_integrals(std::span<const Knowledge> steps, double known_best, double limit_ms) {
    GapIntegrals integrals;
    double primal = 1.0;
    double dual = 1.0;
    double since_ms = 0.0;
    const auto add_until = [&](double until_ms) {
        integrals.primal_ms += primal * (until_ms - since_ms);
        integrals.dual_ms += dual * (until_ms - since_ms);
        since_ms = until_ms;
    };
    for (const Knowledge& step : steps) {
        if (step.time_ms >= limit_ms) break;
        add_until(std::max(step.time_ms, since_ms));
        if (step.objective) primal = relative_distance(step.objective, known_best);
        if (step.bound) dual = relative_distance(step.bound, known_best);
    }
    add_until(limit_ms);
    return integrals;
}

Variability variability_of(std::span<const double> times_ms) {
    if (times_ms.size() < 2) throw InvalidInput("times", "must be at least two");
    const auto [least, most] = std::ranges::minmax(times_ms);
    return {standard_deviation(times_ms) / mean(times_ms), most / least};
}

}  // namespace conelane
