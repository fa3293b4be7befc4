#include "experiments/studies/backend_measures.hpp"

#include "evaluation/scoring/statistics.hpp"
#include "evaluation/scoring/wilcoxon.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

/// The rows that a figure is of.
struct MeasuredGroup {
    std::size_t size = 0;
    std::string condition = {};  ///< empty: all scenes
};

struct BackendSummary : MeasuredGroup {
    std::string backend;
    std::size_t scenes = 0, runs = 0, solved = 0;
    std::size_t errors = 0, refuted = 0;  ///< of all runs of this backend
    double geometric_ms = 0.0, par1_ms = 0.0, par2_ms = 0.0, par10_ms = 0.0, median_ms = 0.0;
    std::size_t common = 0;                                      ///< runs that every backend solved
    std::optional<double> common_geometric_ms;                   ///< over these
    std::optional<double> median_engine_ms;                      ///< in runs that report it
    std::optional<double> variability, spread;                   ///< medians over scenes
    std::size_t integrals = 0;                                   ///< scenes with steps and a known lane graph
    std::optional<double> primal_integral_ms, dual_integral_ms;  ///< means over these
    std::vector<double> profile;                                 ///< at profile_ratios()
    std::size_t won = 0;                                         ///< runs that it solves first
    std::optional<std::size_t> peak_bytes;                       ///< of its block
};

/// Wilcoxon's test on two backends: geometric means of a scene's times, failures at the limit.
struct BackendPair : MeasuredGroup {
    std::string first, second;
    std::size_t scenes = 0;  ///< whose times differ
    double ratio = 1.0;      ///< geometric mean of first / second
    double p_value = 1.0;
    double corrected_p_value = 1.0;  ///< Holm, over the pairs of this size and condition
};

struct BackendSelection : MeasuredGroup {
    std::string single_best;
    double single_par10_ms = 0.0, virtual_par10_ms = 0.0;
};

/// Gaps after some time, over all scenes with steps and a known lane graph.
struct BackendGap : MeasuredGroup {
    std::string backend;
    double time_ms = 0.0, mean_primal_gap = 0.0, mean_dual_gap = 0.0;
};

struct BackendMeasures {
    std::vector<BackendSummary> summaries;  ///< by size, condition and backend
    std::vector<BackendPair> pairs;
    std::vector<BackendSelection> selections;
    std::vector<BackendGap> gaps;
};

/// Multiples of the fastest time at which profiles are evaluated: 1 to 1000, 25 a decade.
std::vector<double> profile_ratios() {
    constexpr int kSteps = 75;
    std::vector<double> ratios;
    for (int k = 0; k <= kSteps; ++k) ratios.push_back(std::pow(10.0, 3.0 * k / kSteps));
    return ratios;
}

constexpr double kPar1 = 1.0;
constexpr double kPar2 = 2.0;
constexpr double kPar10 = 10.0;

/// A scene in one of its orders.
using Run = std::pair<const AnnotatedScene*, std::size_t>;

bool is_solved(const SolveRow& row, double limit_ms) {
    return row.is_proven() && !row.refuted && row.latency_ms <= limit_ms;
}

SolverRun run_of(const SolveRow& row, double limit_ms) {
    return {row.latency_ms, is_solved(row, limit_ms)};
}

/// The rows of one size and condition, by backend in the order in which they first occur, each with its runs.
struct Group : MeasuredGroup {
    std::vector<std::string> backends;
    std::vector<std::map<Run, const SolveRow*>> rows;

    void add(const SolveRow& row) {
        const std::string label = row.backend.label();
        auto place = static_cast<std::size_t>(std::ranges::find(backends, label) - backends.begin());
        if (place == backends.size()) {
            backends.push_back(label);
            rows.emplace_back();
        }
        rows[place].emplace(Run{row.scene, row.permutation}, &row);
    }

    /// Runs that all backends have, in the order of the scenes.
    [[nodiscard]] std::vector<Run> common_runs() const {
        std::vector<Run> common;
        for (const auto& [run, row] : rows.front()) {
            if (std::ranges::all_of(rows, [&run = run](const auto& of_one) { return of_one.contains(run); }))
                common.push_back(run);
        }
        return common;
    }

    /// The objective of the cheapest lane graph that any backend has for the scene.
    [[nodiscard]] std::optional<double> known_best(const AnnotatedScene* scene) const {
        std::optional<double> best;
        for (const auto& of_one : rows) {
            for (auto row = of_one.lower_bound({scene, 0}); row != of_one.end() && row->first.first == scene;
                 ++row) {
                const SolveRow& one = *row->second;
                if (one.status == SolveStatus::error || !one.objective) continue;
                best = std::min(best.value_or(*one.objective), *one.objective);
            }
        }
        return best;
    }
};

std::vector<Group> groups_of_rows(std::span<const SolveRow> rows) {
    std::set<std::string> conditions;
    for (const SolveRow& row : rows) conditions.insert(row.scene->condition);
    std::vector<Group> groups;
    const auto group = [&](std::size_t size, const std::string& condition) -> Group& {
        const auto known = std::ranges::find_if(
            groups, [&](const Group& one) { return one.size == size && one.condition == condition; });
        if (known != groups.end()) return *known;
        return groups.emplace_back(Group{{size, condition}, {}, {}});
    };
    for (const SolveRow& row : rows) group(row.size, "").add(row);
    if (conditions.size() < 2) return groups;
    for (const SolveRow& row : rows) {
        if (!row.scene->condition.empty()) group(row.size, row.scene->condition).add(row);
    }
    return groups;
}

/// The times of each scene over its orders, failures at the limit.
std::map<const AnnotatedScene*, std::vector<double>> times_by_scene(
    const std::map<Run, const SolveRow*>& rows, std::span<const Run> runs, double limit_ms) {
    std::map<const AnnotatedScene*, std::vector<double>> times;
    for (const Run& run : runs) {
        const SolverRun one = run_of(*rows.at(run), limit_ms);
        times[run.first].push_back(one.solved ? one.time_ms : limit_ms);
    }
    return times;
}

void add_variability(BackendSummary& summary, const std::map<Run, const SolveRow*>& rows, double limit_ms) {
    std::vector<Run> runs;
    for (const auto& [run, row] : rows) runs.push_back(run);
    Sample coefficients, spreads;
    for (const auto& [scene, times] : times_by_scene(rows, runs, limit_ms)) {
        if (times.size() < 2) continue;
        const Variability one = variability_of(times);
        coefficients.add(one.coefficient);
        spreads.add(one.ratio);
    }
    summary.variability = coefficients.median();
    summary.spread = spreads.median();
}

void add_integrals(BackendSummary& summary, const Group& group, const std::map<Run, const SolveRow*>& rows,
                   double limit_ms) {
    Sample primal, dual;
    for (const auto& [run, row] : rows) {
        const auto best = group.known_best(run.first);
        if (row->steps.empty() || !best || row->refuted) continue;
        const GapIntegrals integrals = gap_integrals(row->steps, *best, limit_ms);
        primal.add(integrals.primal_ms);
        dual.add(integrals.dual_ms);
    }
    summary.integrals = primal.values().size();
    summary.primal_integral_ms = primal.mean();
    summary.dual_integral_ms = dual.mean();
}

/// Runs of every backend, in one order.
std::vector<std::vector<SolverRun>> runs_by_backend(const Group& group, std::span<const Run> common,
                                                    double limit_ms) {
    std::vector<std::vector<SolverRun>> runs;
    for (const auto& of_one : group.rows) {
        auto& of_backend = runs.emplace_back();
        for (const Run& run : common) of_backend.push_back(run_of(*of_one.at(run), limit_ms));
    }
    return runs;
}

void add_summaries(const Group& group, std::span<const Run> common, double limit_ms,
                   std::vector<BackendSummary>& summaries) {
    const std::vector<std::vector<SolverRun>> runs = runs_by_backend(group, common, limit_ms);
    const std::vector<std::size_t> by_all = solved_by_all(runs);
    const BestSolvers best = best_solvers(runs, limit_ms);
    const std::vector<std::vector<double>> profiles = performance_profiles(runs, profile_ratios());
    std::set<const AnnotatedScene*> scenes;
    for (const Run& run : common) scenes.insert(run.first);
    for (std::size_t b = 0; b < group.backends.size(); ++b) {
        BackendSummary summary;
        static_cast<MeasuredGroup&>(summary) = group;
        summary.backend = group.backends[b];
        summary.scenes = scenes.size();
        summary.runs = common.size();
        Sample engine_ms;
        for (const Run& run : common) {
            const SolveRow& row = *group.rows[b].at(run);
            summary.solved += is_solved(row, limit_ms) ? 1 : 0;
            engine_ms.add(row.engine_ms);
        }
        for (const auto& [run, row] : group.rows[b]) {
            summary.refuted += row->refuted ? 1 : 0;
            summary.errors += row->refuted || row->status == SolveStatus::error ? 1 : 0;
        }
        const std::vector<double> times = penalised_times_ms(runs[b], limit_ms);
        summary.geometric_ms = shifted_geometric_mean(times, kGeometricMeanShift_ms);
        summary.median_ms = median(times);
        summary.par1_ms = penalised_average_ms(runs[b], limit_ms, kPar1);
        summary.par2_ms = penalised_average_ms(runs[b], limit_ms, kPar2);
        summary.par10_ms = penalised_average_ms(runs[b], limit_ms, kPar10);
        summary.common = by_all.size();
        if (!by_all.empty()) {
            std::vector<double> of_common;
            for (const std::size_t run : by_all) of_common.push_back(runs[b][run].time_ms);
            summary.common_geometric_ms = shifted_geometric_mean(of_common, kGeometricMeanShift_ms);
        }
        summary.median_engine_ms = engine_ms.median();
        summary.profile = profiles[b];
        summary.won = best.won[b];
        add_variability(summary, group.rows[b], limit_ms);
        add_integrals(summary, group, group.rows[b], limit_ms);
        summaries.push_back(std::move(summary));
    }
}

void add_pairs(const Group& group, std::span<const Run> common, double limit_ms,
               std::vector<BackendPair>& pairs) {
    std::vector<std::vector<double>> logarithms;  // of each scene's geometric mean time
    for (const auto& of_one : group.rows) {
        auto& of_backend = logarithms.emplace_back();
        for (const auto& [scene, times] : times_by_scene(of_one, common, limit_ms)) {
            double sum = 0.0;
            for (const double time : times) sum += std::log(std::max(time, 1e-6));
            of_backend.push_back(sum / static_cast<double>(times.size()));
        }
    }
    const std::size_t first_pair = pairs.size();
    std::vector<double> p_values;
    for (std::size_t a = 0; a < group.backends.size(); ++a) {
        for (std::size_t b = a + 1; b < group.backends.size(); ++b) {
            const SignedRankTest test = signed_rank_test(logarithms[a], logarithms[b]);
            pairs.push_back({group, group.backends[a], group.backends[b], test.pairs,
                             std::exp(mean(logarithms[a]) - mean(logarithms[b])), test.p_value, 1.0});
            p_values.push_back(test.p_value);
        }
    }
    const std::vector<double> corrected = holm_corrected(p_values);
    for (std::size_t k = 0; k < corrected.size(); ++k) pairs[first_pair + k].corrected_p_value = corrected[k];
}

void add_gaps(const Group& group, double limit_ms, std::vector<BackendGap>& gaps) {
    for (std::size_t b = 0; b < group.backends.size(); ++b) {
        std::vector<std::pair<const SolveRow*, double>> with_steps;
        for (const auto& [run, row] : group.rows[b]) {
            const auto best = group.known_best(run.first);
            if (!row->steps.empty() && best && !row->refuted) with_steps.emplace_back(row, *best);
        }
        if (with_steps.empty()) continue;
        constexpr double kStep = 1.2589254117941673;  // ten steps a decade
        for (double time_ms = 0.1; time_ms <= limit_ms * (1.0 + 1e-9); time_ms *= kStep) {
            BackendGap gap{group, group.backends[b], time_ms, 0.0, 0.0};
            for (const auto& [row, best] : with_steps) {
                std::optional<double> objective, bound;
                for (const Knowledge& step : row->steps) {
                    if (step.time_ms > time_ms) break;
                    if (step.objective) objective = step.objective;
                    if (step.bound) bound = step.bound;
                }
                gap.mean_primal_gap += relative_distance(objective, best);
                gap.mean_dual_gap += relative_distance(bound, best);
            }
            gap.mean_primal_gap /= static_cast<double>(with_steps.size());
            gap.mean_dual_gap /= static_cast<double>(with_steps.size());
            gaps.push_back(gap);
        }
    }
}

/// The kind of a row, and what it is of.
template <typename Row>
RowFields<Row> fields_of(const char* kind, const RowFields<Row>& others) {
    RowFields<Row> fields{
        {"row", [kind](const Row&) { return kind; }},
        {"nearest", &Row::size},
        {"condition", [](const Row& row) { return row.condition.empty() ? FieldValue() : row.condition; }},
        {"",
         [](const Row& row) {
             return size_name(row.size) + (row.condition.empty() ? "" : " " + row.condition);
         },
         Shown::text("n")}};
    fields.insert(fields.end(), others.begin(), others.end());
    return fields;
}

RowFields<BackendSummary> summary_fields() {
    using Row = BackendSummary;
    constexpr double kMiB = 1024.0 * 1024.0;
    const auto mib = [](const Row& row) {
        return row.peak_bytes ? std::optional(static_cast<double>(*row.peak_bytes) / kMiB) : std::nullopt;
    };
    return fields_of<Row>(
        "summary",
        {{"backend", &Row::backend, Shown::text("backend")},
         {"scenes", &Row::scenes},
         {"runs", &Row::runs, Shown::number("runs")},
         {"solved", &Row::solved},
         {"", [](const Row& row) { return share(row.solved, row.runs); }, Shown::percent("solved %", 1)},
         {"errors", &Row::errors, Shown::number("errors")},
         {"refuted", &Row::refuted},
         {"geometric_ms", &Row::geometric_ms, Shown::fixed("geo ms", 2)},
         {"par1_ms", &Row::par1_ms, Shown::fixed("PAR1 ms", 2)},
         {"par2_ms", &Row::par2_ms, Shown::fixed("PAR2 ms", 2)},
         {"par10_ms", &Row::par10_ms, Shown::fixed("PAR10 ms", 2)},
         {"common", &Row::common, Shown::number("by all")},
         {"common_geometric_ms", &Row::common_geometric_ms, Shown::fixed("geo ms", 2)},
         {"median_ms", &Row::median_ms},
         {"median_engine_ms", &Row::median_engine_ms, Shown::fixed("engine ms", 2)},
         {"variability", &Row::variability, Shown::percent("variation %", 1)},
         {"spread", &Row::spread, Shown::fixed("max/min", 2)},
         {"integrals", &Row::integrals},
         {"primal_integral_ms", &Row::primal_integral_ms, Shown::fixed("primal ms", 2)},
         {"dual_integral_ms", &Row::dual_integral_ms, Shown::fixed("dual ms", 2)},
         {"profile", &Row::profile},
         {"won", &Row::won, Shown::number("first")},
         {"", mib, Shown::fixed("MiB", 1)}});
}

RowFields<BackendPair> pair_fields() {
    using Row = BackendPair;
    const auto short_p = [](double Row::*p) {
        return [p](const Row& row) { return fmt::format("{:.2g}", row.*p); };
    };
    return fields_of<Row>(
        "pair", {{"first", &Row::first},
                 {"second", &Row::second},
                 {"", [](const Row& row) { return row.first + " : " + row.second; }, Shown::text("pair")},
                 {"scenes", &Row::scenes},
                 {"ratio", &Row::ratio, Shown::fixed("time ratio", 2)},
                 {"p_value", &Row::p_value},
                 {"", short_p(&Row::p_value), Shown::number("p")},
                 {"corrected_p_value", &Row::corrected_p_value},
                 {"", short_p(&Row::corrected_p_value), Shown::number("p (Holm)")}});
}

RowFields<BackendSelection> selection_fields() {
    using Row = BackendSelection;
    return fields_of<Row>(
        "selection",
        {{"single_best", &Row::single_best, Shown::text("single best")},
         {"single_par10_ms", &Row::single_par10_ms, Shown::fixed("PAR10 ms", 2)},
         {"virtual_par10_ms", &Row::virtual_par10_ms, Shown::fixed("virtual best PAR10 ms", 2)}});
}

RowFields<BackendGap> gap_fields() {
    using Row = BackendGap;
    return fields_of<Row>("gap", {{"backend", &Row::backend},
                                  {"time_ms", &Row::time_ms},
                                  {"mean_primal_gap", &Row::mean_primal_gap},
                                  {"mean_dual_gap", &Row::mean_dual_gap}});
}

BackendMeasures measures_of(const SolveResults& results, double time_limit_ms) {
    BackendMeasures measures;
    for (const Group& group : groups_of_rows(results.rows)) {
        const std::vector<Run> common = group.common_runs();
        if (common.empty()) continue;
        add_summaries(group, common, time_limit_ms, measures.summaries);
        add_pairs(group, common, time_limit_ms, measures.pairs);
        const BestSolvers best = best_solvers(runs_by_backend(group, common, time_limit_ms), time_limit_ms);
        measures.selections.push_back(
            {group, group.backends[best.single_best], best.single_par10_ms, best.virtual_par10_ms});
        if (group.condition.empty()) add_gaps(group, time_limit_ms, measures.gaps);
    }
    for (BackendSummary& summary : measures.summaries) {
        for (const SolveBlock& block : results.blocks) {
            if (block.size == summary.size && block.backend == summary.backend)
                summary.peak_bytes = block.peak_bytes;
        }
    }
    return measures;
}

}  // namespace

void add_measures(StudyResult& result, const SolveResults& results, double time_limit_ms) {
    const BackendMeasures measures = measures_of(results, time_limit_ms);
    result.table += row_table(measures.summaries, summary_fields()) + '\n';
    if (!measures.pairs.empty()) result.table += row_table(measures.pairs, pair_fields()) + '\n';
    result.table += row_table(measures.selections, selection_fields());
    result.add_rows(measures.summaries, summary_fields());
    result.add_rows(measures.pairs, pair_fields());
    result.add_rows(measures.selections, selection_fields());
    result.add_rows(measures.gaps, gap_fields());
}

}  // namespace conelane::experiments
