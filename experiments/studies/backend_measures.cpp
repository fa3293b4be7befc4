#include "experiments/studies/backend_measures.hpp"

#include <set>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

/// The rows that a figure is of.
struct MeasuredGroup {
    std::size_t size = 0;
    std::string condition = {};  ///< empty: all scenes
};

/// 95 %, of courses drawn again.
using Interval = std::optional<std::pair<double, double>>;

struct BackendSummary : MeasuredGroup {
    std::string backend;
    std::size_t scenes = 0, runs = 0, solved = 0;
    std::size_t errors = 0, refuted = 0;  ///< of all runs of this backend
    double geometric_ms = 0.0, par10_ms = 0.0, median_ms = 0.0;
    Interval geometric_interval, par10_interval;
    std::optional<double> median_engine_ms;                      ///< in runs that report it
    std::optional<double> variability, spread;                   ///< medians over scenes
    std::size_t integrals = 0;                                   ///< scenes with steps and a known lane graph
    std::optional<double> primal_integral_ms, dual_integral_ms;  ///< means over these
    std::vector<double> profile;                                 ///< at profile_ratios()
    std::size_t won = 0;                                         ///< runs that it solves first
    double contribution_ms = 0.0;           ///< PAR10 of the virtual best without it, less that with it
    std::optional<std::size_t> peak_bytes;  ///< of its block
};

/// A backend and the reference, on the same runs, failures at the limit.
struct BackendPair : MeasuredGroup {
    std::string first, second;
    std::size_t courses = 0;  ///< whose means differ
    double ratio = 1.0;       ///< geometric mean of first / second
    Interval ratio_interval;
    double p_value = 1.0;            ///< Wilcoxon's test on the means of courses
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

void add_variability(BackendSummary& summary, const std::map<Run, const SolveRow*>& rows, double limit_ms) {
    std::map<const AnnotatedScene*, std::vector<double>> times_of;  // over its orders, failures at the limit
    for (const auto& [run, row] : rows) {
        const SolverRun one = run_of(*row, limit_ms);
        times_of[run.first].push_back(one.solved ? one.time_ms : limit_ms);
    }
    Sample coefficients, spreads;
    for (const auto& [scene, times] : times_of) {
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

std::vector<std::string> courses_of(std::span<const Run> runs) {
    std::vector<std::string> courses;
    for (const Run& run : runs) courses.push_back(run.first->track);
    return courses;
}

std::vector<double> logarithms(std::vector<double> times, double shift) {
    for (double& time : times) time = std::log(std::max(time + shift, 1e-6));
    return times;
}

/// The exponentials of an interval's ends, less the shift.
Interval exponential(const Interval& interval, double shift) {
    if (!interval) return interval;
    return std::pair(std::exp(interval->first) - shift, std::exp(interval->second) - shift);
}

void add_times(BackendSummary& summary, const std::vector<SolverRun>& runs,
               const std::vector<std::string>& courses, double limit_ms) {
    constexpr double kShift = kGeometricMeanShift_ms;
    const std::vector<double> times = penalised_times_ms(runs, limit_ms);
    const CourseMean geometric = course_mean(logarithms(times, kShift), courses);
    summary.geometric_ms = std::exp(geometric.mean) - kShift;
    summary.geometric_interval = exponential(geometric.interval, kShift);
    summary.median_ms = median(times);
    const CourseMean par10 = course_mean(penalised_times_ms(runs, limit_ms, kPar10), courses);
    summary.par10_ms = par10.mean;
    summary.par10_interval = par10.interval;
}

void add_summaries(const Group& group, std::span<const Run> common, double limit_ms,
                   std::vector<BackendSummary>& summaries) {
    const std::vector<std::vector<SolverRun>> runs = runs_by_backend(group, common, limit_ms);
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
        add_times(summary, runs[b], courses_of(common), limit_ms);
        summary.median_engine_ms = engine_ms.median();
        summary.profile = profiles[b];
        summary.won = best.won[b];
        if (runs.size() > 1) {
            std::vector<std::vector<SolverRun>> others = runs;
            others.erase(others.begin() + static_cast<std::ptrdiff_t>(b));
            summary.contribution_ms = best_solvers(others, limit_ms).virtual_par10_ms - best.virtual_par10_ms;
        }
        add_variability(summary, group.rows[b], limit_ms);
        add_integrals(summary, group, group.rows[b], limit_ms);
        summaries.push_back(std::move(summary));
    }
}

void add_pairs(const Group& group, std::span<const Run> common, double limit_ms, const std::string& reference,
               std::vector<BackendPair>& pairs) {
    const auto named = std::ranges::find(group.backends, reference);
    const auto second =
        static_cast<std::size_t>(named == group.backends.end() ? 0 : named - group.backends.begin());
    const std::vector<std::string> courses = courses_of(common);
    std::vector<std::vector<double>> of_backend;
    for (const std::vector<SolverRun>& runs : runs_by_backend(group, common, limit_ms))
        of_backend.push_back(logarithms(penalised_times_ms(runs, limit_ms), 0.0));
    const std::size_t first_pair = pairs.size();
    std::vector<double> p_values;
    for (std::size_t b = 0; b < group.backends.size(); ++b) {
        if (b == second) continue;
        std::vector<double> differences;
        std::ranges::transform(of_backend[b], of_backend[second], std::back_inserter(differences),
                               std::minus());
        const CourseMean ratio = course_mean(differences, courses);
        const SignedRankTest test =
            signed_rank_test(ratio.of_course, std::vector<double>(ratio.of_course.size(), 0.0));
        pairs.push_back({group, group.backends[b], group.backends[second], test.pairs, std::exp(ratio.mean),
                         exponential(ratio.interval, 0.0), test.p_value, 1.0});
        p_values.push_back(test.p_value);
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

/// An interval: a list in the file, two numbers in the table.
template <typename Row>
void add_interval(RowFields<Row>& fields, const std::string& after, Interval Row::*interval) {
    const auto in_file = [interval](const Row& row) {
        return row.*interval ? FieldValue(Json{(row.*interval)->first, (row.*interval)->second})
                             : std::nullopt;
    };
    const auto in_table = [interval](const Row& row) {
        return row.*interval ? fmt::format("{:.3g}-{:.3g}", (row.*interval)->first, (row.*interval)->second)
                             : "-";
    };
    const auto place = std::ranges::find(fields, after, &RowField<Row>::key);
    fields.insert(std::next(place), {{after + "_interval", in_file}, {"", in_table, Shown::number("95 %")}});
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
    RowFields<Row> fields = fields_of<Row>(
        "summary",
        {{"backend", &Row::backend, Shown::text("backend")},
         {"scenes", &Row::scenes},
         {"runs", &Row::runs, Shown::number("runs")},
         {"solved", &Row::solved},
         {"", [](const Row& row) { return share(row.solved, row.runs); }, Shown::percent("solved %", 1)},
         {"errors", &Row::errors, Shown::number("errors")},
         {"refuted", &Row::refuted, Shown::number("refuted")},
         {"median_ms", &Row::median_ms, Shown::fixed("median ms", 2)},
         {"geometric_ms", &Row::geometric_ms, Shown::fixed("geo ms", 2)},
         {"par10_ms", &Row::par10_ms, Shown::fixed("PAR10 ms", 2)},
         {"median_engine_ms", &Row::median_engine_ms, Shown::fixed("engine ms", 2)},
         {"variability", &Row::variability, Shown::percent("variation %", 1)},
         {"spread", &Row::spread, Shown::fixed("max/min", 2)},
         {"integrals", &Row::integrals},
         {"primal_integral_ms", &Row::primal_integral_ms, Shown::fixed("primal ms", 2)},
         {"dual_integral_ms", &Row::dual_integral_ms, Shown::fixed("dual ms", 2)},
         {"profile", &Row::profile},
         {"won", &Row::won, Shown::number("first")},
         {"contribution_ms", &Row::contribution_ms, Shown::fixed("adds ms", 2)},
         {"", mib, Shown::fixed("MiB", 1)}});
    add_interval(fields, "geometric_ms", &Row::geometric_interval);
    add_interval(fields, "par10_ms", &Row::par10_interval);
    return fields;
}

RowFields<BackendPair> pair_fields() {
    using Row = BackendPair;
    const auto short_p = [](double Row::*p) {
        return [p](const Row& row) { return fmt::format("{:.2g}", row.*p); };
    };
    RowFields<Row> fields = fields_of<Row>(
        "pair", {{"first", &Row::first},
                 {"second", &Row::second},
                 {"", [](const Row& row) { return row.first + " : " + row.second; }, Shown::text("pair")},
                 {"courses", &Row::courses, Shown::number("courses")},
                 {"ratio", &Row::ratio, Shown::fixed("time ratio", 2)},
                 {"p_value", &Row::p_value},
                 {"", short_p(&Row::p_value), Shown::number("p")},
                 {"corrected_p_value", &Row::corrected_p_value},
                 {"", short_p(&Row::corrected_p_value), Shown::number("p (Holm)")}});
    add_interval(fields, "ratio", &Row::ratio_interval);
    return fields;
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

BackendMeasures measures_of(const SolveResults& results, double time_limit_ms, const std::string& reference) {
    BackendMeasures measures;
    for (const Group& group : groups_of_rows(results.rows)) {
        const std::vector<Run> common = group.common_runs();
        if (common.empty()) continue;
        add_summaries(group, common, time_limit_ms, measures.summaries);
        add_pairs(group, common, time_limit_ms, reference, measures.pairs);
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

void add_measures(StudyResult& result, const SolveResults& results, double time_limit_ms,
                  const std::string& reference) {
    const BackendMeasures measures = measures_of(results, time_limit_ms, reference);
    result.table += row_table(measures.summaries, summary_fields()) + '\n';
    if (!measures.pairs.empty()) result.table += row_table(measures.pairs, pair_fields()) + '\n';
    result.table += row_table(measures.selections, selection_fields());
    result.add_rows(measures.summaries, summary_fields());
    result.add_rows(measures.pairs, pair_fields());
    result.add_rows(measures.selections, selection_fields());
    result.add_rows(measures.gaps, gap_fields());
}

}  // namespace conelane::experiments
