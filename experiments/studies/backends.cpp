#include "evaluation/formats/provenance.hpp"
#include "experiments/comparison/runner.hpp"
#include "experiments/studies/backend_measures.hpp"
#include "experiments/studies/machine.hpp"
#include "solvers/registry.hpp"

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
        const bool is_nothing = value.empty() || value == 0U || value == false || value == Json("");
        return is_nothing ? std::nullopt : FieldValue(value);
    };
}

RowFields<SolveRow> fields_of_file() {
    using Row = SolveRow;
    return with_scene<Row>(
        {{"nearest", &Row::size},
         {"cones", &Row::cones},
         {"scene_hash", if_any(&Row::scene_hash)},
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
         {"limit_ms", &Row::limit_ms},
         {"latency_ms", &Row::latency_ms},
         {"engine_ms", &Row::engine_ms},
         {"steps", if_any(steps_json)}});
}

const RowFields<SolveBlock> kBlockFields{{"row", [](const SolveBlock&) { return "block"; }},
                                         {"nearest", &SolveBlock::size},
                                         {"backend", &SolveBlock::backend},
                                         {"version", &SolveBlock::version},
                                         {"treatment", &SolveBlock::treatment},
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
                        "exact solvers: SOLVER[/FORMULATION][/all-rows], separated by commas; all for every "
                        "solver; or exec:NAME[...]=COMMAND, a program from outside, in an argument of its "
                        "own")
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
                         "each solver of programs also on one program with all rows");
        command
            .add_option("--permutations", solves_.permutations,
                        "number of additional runs of each scene without a start, with cones, rows and "
                        "columns in other orders")
            ->check(whole_number(0, 1000))
            ->capture_default_str();
        command.add_option("--seed", solves_.seed, "of the permutations")
            ->check(seed_number())
            ->capture_default_str();
        add_limits_option(
            command, "--gap-limits", solves_.gap_limits_ms,
            "time limits [ms], ascending: each scene is solved again under each, for the gap over time");
        add_limits_option(
            command, "--then", solves_.then_ms,
            "longer time limits [ms], ascending: each solve that the limit before ends unproven "
            "is solved again under it");
        command.add_option("--reference", reference_,
                           "the backend that all others are compared with, as tables name it; the first "
                           "without it");
        command
            .add_option("--stored", stored_,
                        "rows that earlier calls wrote: what they prove, or solved as long, is not solved "
                        "again")
            ->delimiter(',')
            ->excludes("--warm-start", "--gap-limits");
        add_shard_option(command, shard_,
                         "every N-th course from the I-th on, I from 0; join them by --stored");
    }

  protected:
    StudyResult aggregate(const SceneSet& set, SolveOptions solves) override {
        if (!std::isfinite(solves.time_limit_ms))
            throw InvalidInput("--time-limit", "every row records one, inf is none");
        require_ascending("--gap-limits", solves.gap_limits_ms);
        std::vector<double> limits_ms = solves.then_ms;
        limits_ms.insert(limits_ms.begin(), solves.time_limit_ms);
        require_ascending("--then", limits_ms);
        solves.backends = backends_asked_for();
        const std::string parameters = tag_of("", solves.parameters).hash.value();
        const StoredRows stored(stored_, parameters);
        if (!stored_.empty()) solves.stored = &stored;
        const std::vector<AnnotatedScene> scenes = of_shard(set.scenes);
        SolveResults results = solve_scenes(scenes, solves);
        mark_refuted_claims(results.rows);
        StudyResult result{left_out(solves)};
        result.add_rows(results.rows, fields_of_file());
        for (Json& row : result.rows) row["parameters"] = parameters;
        result.add_rows(results.blocks, kBlockFields);
        add_measures(result, results, solves.longest_limit_ms(), reference_);
        result.table += '\n' + machine(results);
        result.errors = errors_among(results.rows);
        return result;
    }

  private:
    /// Those of the shard's courses, which count in the order in which they appear.
    [[nodiscard]] std::vector<AnnotatedScene> of_shard(const std::vector<AnnotatedScene>& scenes) const {
        std::map<std::string, std::size_t> courses;
        std::vector<AnnotatedScene> mine;
        for (const AnnotatedScene& scene : scenes) {
            const std::size_t course = courses.try_emplace(scene.track, courses.size()).first->second;
            if (course % shard_.count == shard_.index) mine.push_back(scene);
        }
        return mine;
    }

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
                if (all_rows_ && one.uses_formulation() && !one.all_rows)
                    all.push_back(one), all.back().all_rows = true;
            }
        };
        for (const std::string& solver : split_detectors(solvers_)) {
            if (solver == "all") {
                for (const Backend& backend : exact_backends()) add(backend, false);
                continue;
            }
            const std::string name = solver.substr(0, solver.find('='));
            add(backend_of(solver),
                name.find("/tight") != std::string::npos || name.find("/paper") != std::string::npos);
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
        std::map<std::string, std::string> backends;
        for (const SolveBlock& block : results.blocks) {
            reference_ms.push_back(block.reference_ms);
            backends.emplace(block.backend,
                             fmt::format("{} ({})", block.version.empty() ? "version unknown" : block.version,
                                         block.treatment));
        }
        std::string lines;
        for (const auto& [backend, said] : backends) lines += fmt::format("{}: {}\n", backend, said);
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
    std::string reference_;
    std::vector<std::string> stored_;
    Shard shard_;
};

}  // namespace

std::unique_ptr<Study> make_backends_study() {
    return std::make_unique<BackendsStudy>();
}

}  // namespace conelane::experiments
