#include "conelane/invalid_input.hpp"
#include "evaluation/formats/provenance.hpp"
#include "evaluation/scoring/statistics.hpp"
#include "experiments/comparison/runner.hpp"
#include "experiments/options/shared_options.hpp"
#include "experiments/studies/backend_measures.hpp"
#include "experiments/studies/machine.hpp"
#include "experiments/studies/solve_study.hpp"
#include "experiments/studies/study.hpp"
#include "solvers/registry.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

Json steps_json(const SolveRow& row) {
    const RowFields<Knowledge> fields{
        {"time_ms", &Knowledge::time_ms},
        {"objective", &Knowledge::objective},
        {"bound", [](const Knowledge& step) { return bound_value(step.bound); }}};
    Json steps;
    for (const Knowledge& step : row.steps) steps.push_back(row_json(step, fields));
    return steps;
}

/// An empty text, a zero or an empty list has no key.
template <typename Get>
auto if_any(const Get& get) {
    return [get](const SolveRow& row) {
        const Json value = std::invoke(get, row);
        return value.empty() || value == 0U || value == false || value == "" ? std::nullopt
                                                                             : FieldValue(value);
    };
}

RowFields<SolveRow> fields_of_file() {
    using Row = SolveRow;
    return with_scene<Row>(
        {{"nearest", &Row::size},
         {"cones", &Row::cones},
         {"backend", [](const Row& row) { return row.backend.label(); }},
         {"status", [](const Row& row) { return row.refuted ? SolveStatus::error : row.status; }},
         {"condition", if_any([](const Row& row) { return row.scene->condition; })},
         {"permutation", if_any(&Row::permutation)},
         {"message", if_any(&Row::message)},
         {"refuted", if_any(&Row::refuted)},
         {"objective", &Row::objective},
         {"bound", [](const Row& row) { return bound_value(row.bound); }},
         {"nodes", &Row::nodes},
         {"rounds", &Row::rounds},
         {"latency_ms", &Row::latency_ms},
         {"engine_ms", &Row::engine_ms},
         {"steps", if_any(steps_json)}});
}

/// A line for each size and backend: errors and refuted claims in every order, all else for the scenes in
/// their original order.
std::string backend_table(std::span<const SolveRow> rows) {
    using Row = SolveRow;
    const auto original = [](const Row& row) { return row.permutation == 0; };
    const auto is_error = [](const Row& row) { return row.status == SolveStatus::error; };
    const auto status = [&](auto is) {
        return count_of([=](const Row& row) {
            return original(row) && !row.refuted && !is_error(row) && std::invoke(is, row);
        });
    };
    const auto of_original = [&](auto get) {
        return [=](const Row& row) {
            return original(row) ? std::optional<double>(std::invoke(get, row)) : std::nullopt;
        };
    };
    const auto latency_ms = of_original(&Row::latency_ms);
    const RowFields<RowGroup<Row>> fields{
        {"", first_of(&Row::size_text), Shown::number("n")},
        {"", first_of([](const Row& row) { return row.backend.label(); }), Shown::text("backend")},
        {"", count_of(original), Shown::number("scenes")},
        {"", status(&Row::is_optimal), Shown::number("optimal")},
        {"", status(&Row::is_infeasible), Shown::number("infeasible")},
        {"", status(std::not_fn(&Row::is_proven)), Shown::number("unproven")},
        {"", count_of([=](const Row& row) { return is_error(row) && !row.refuted; }),
         Shown::number("errors")},
        {"", count_of(&Row::refuted), Shown::number("refuted")},
        {"", mean_of(of_original(&Row::nodes)), Shown::fixed("nodes", 1)},
        {"", median_of(latency_ms), Shown::fixed("median ms", 2)},
        {"", quantile_of(latency_ms, 0.95), Shown::fixed("p95 ms", 2)},
        {"", quantile_of(latency_ms, 1.0), Shown::fixed("max ms", 2)}};
    return row_table(
        groups_of<Row>(rows, [](const Row& row) { return std::pair(row.size, row.backend.label()); }),
        fields);
}

const RowFields<SolveBlock> kBlockFields{{"row", [](const SolveBlock&) { return "block"; }},
                                         {"nearest", &SolveBlock::size},
                                         {"backend", &SolveBlock::backend},
                                         {"version", &SolveBlock::version},
                                         {"reference_ms", &SolveBlock::reference_ms},
                                         {"peak_bytes", &SolveBlock::peak_bytes}};

class BackendsStudy : public SolveStudy {
  public:
    BackendsStudy()
        : SolveStudy(
              {"backends", "how fast is every exact solver on the same cone sets, and do all agree?",
               "Scene after scene in travel order, one thread, pinned; the time is from the scene in memory "
               "to the lane graph in memory, of a program from outside with files and pipes. Every lane "
               "graph passes the independent checker or counts as an error; a claim that another backend's "
               "lane graph refutes is one too. A warm start is the last lane graph of the lap, its cones "
               "found again by id. Between blocks, a size of a backend each, a reference problem is timed. "
               "Measures: docs/measures.md."},
              {.sizes = {12, 30}, .with_machine = true}) {}

    void add_options(CLI::App& command) override {
        SolveStudy::add_options(command);
        command
            .add_option("--solvers", solvers_,
                        "exact solvers: SOLVER or SOLVER/FORMULATION, separated by commas; all for every "
                        "solver; or exec:NAME=COMMAND, a program from outside, in an argument of its own")
            ->capture_default_str();
        command
            .add_option("--formulations", formulations_,
                        "formulations for solvers that use one and do not name one")
            ->delimiter(',')
            ->check(CLI::IsMember({"tight", "paper"}))
            ->capture_default_str();
        command.add_flag("--warm-start", warm_start_,
                         "each also from the lane graph of the scene before, its cones found again by id");
        command.add_flag("--all-rows", all_rows_,
                         "each program from outside also on files with all rows, asked once");
        command
            .add_option("--permutations", solves_.permutations,
                        "number of additional runs of each scene without a start, with cones, rows and "
                        "columns in other orders")
            ->check(whole_number(0, 1000))
            ->capture_default_str();
        command.add_option("--seed", solves_.seed, "of the permutations")->capture_default_str();
        add_limits_option(
            command, "--gap-limits", solves_.gap_limits_ms,
            "time limits [ms], ascending: each scene is solved again under each, for the gap over time");
    }

  protected:
    StudyResult aggregate(const SceneSet& set, SolveOptions solves) override {
        require_ascending("--gap-limits", solves.gap_limits_ms);
        solves.backends = backends_asked_for();
        SolveResults results = solve_scenes(set.scenes, solves);
        mark_refuted_claims(results.rows);
        StudyResult result{backend_table(results.rows) + left_out(solves) + '\n'};
        result.add_rows(results.rows, fields_of_file());
        result.add_rows(results.blocks, kBlockFields);
        add_measures(result, results, solves.time_limit_ms);
        result.table += '\n' + machine(results);
        result.errors = errors_among(results.rows);
        return result;
    }

  private:
    [[nodiscard]] std::vector<Formulation> formulations_asked_for() const {
        std::vector<Formulation> all;
        for (const std::string& name : formulations_)
            all.push_back(name == "paper" ? Formulation::paper : Formulation::tight);
        return all;
    }

    /// In the order of --solvers; with --all-rows and --warm-start, each solver once more for each option.
    [[nodiscard]] std::vector<Backend> backends_asked_for() const {
        std::vector<Backend> all;
        const auto add = [&](const Backend& backend, bool names_formulation) {
            std::vector<Backend> of_one{backend};
            if (!names_formulation && backend.uses_formulation()) {
                of_one.clear();
                for (const Formulation formulation : formulations_asked_for()) {
                    of_one.push_back(backend);
                    of_one.back().formulation = formulation;
                }
            }
            for (const Backend& one : of_one) {
                all.push_back(one);
                if (warm_start_) all.push_back(one), all.back().warm_start = true;
                if (all_rows_ && one.outside) all.push_back(one), all.back().all_rows = true;
            }
        };
        for (const std::string& solver : split_detectors(solvers_)) {
            if (solver == "all") {
                for (const Backend& backend : exact_backends()) add(backend, false);
                continue;
            }
            const std::string name = solver.substr(0, solver.find('='));
            add(backend_of(solver), name.find('/') != std::string::npos);
        }
        std::vector<std::string> labels;
        for (const Backend& backend : all) {
            if (std::ranges::find(labels, backend.label()) != labels.end())
                throw InvalidInput("--solvers", "two backends have the name " + backend.label());
            labels.push_back(backend.label());
        }
        return all;
    }

    /// A line for each backend and size that was not solved.
    static std::string left_out(const SolveOptions& solves) {
        std::string lines;
        for (const Backend& backend : solves.backends) {
            for (const std::size_t size : solves.sizes) {
                if (backend.takes(size)) continue;
                lines += fmt::format("{} takes at most {} cones: left out at n = {}\n", backend.label(),
                                     *find_rld_solver(backend.solver)->max_cones, size_name(size));
            }
        }
        return lines;
    }

    static std::string machine(const SolveResults& results) {
        std::vector<double> reference_ms;
        std::map<std::string, std::string> versions;
        for (const SolveBlock& block : results.blocks) {
            reference_ms.push_back(block.reference_ms);
            versions.emplace(block.backend, block.version);
        }
        std::string lines;
        for (const auto& [backend, version] : versions)
            lines += fmt::format("{}: {}\n", backend, version.empty() ? "version unknown" : version);
        lines += provenance().machine + '\n';
        if (reference_ms.empty()) return lines;
        return lines + fmt::format(
                           "reference problem: {:.3f} ms, median of {} blocks, coefficient of variation "
                           "{:.1f} %\n",
                           median(reference_ms), reference_ms.size(),
                           100.0 * coefficient_of_variation(reference_ms));
    }

    std::vector<std::string> solvers_{"all"};
    std::vector<std::string> formulations_{"tight"};
    bool warm_start_ = false;
    bool all_rows_ = false;
};

}  // namespace

std::unique_ptr<Study> make_backends_study() {
    return std::make_unique<BackendsStudy>();
}

}  // namespace conelane::experiments
