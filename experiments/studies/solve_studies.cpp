#include "evaluation/scoring/score.hpp"
#include "experiments/studies/solve_rows.hpp"
#include "model/strip_model.hpp"
#include "solvers/milp/strip_milp.hpp"
#include "solvers/registry.hpp"
#include "solvers/relaxation/relaxation_solver.hpp"

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

/// A solve, and its program. A solve that reached the time limit counts with its time.
struct ProgramRow : SolveRow {
    std::size_t columns = 0;
    std::size_t rows = 0;
    std::size_t entries = 0;
    /// (optimum - relaxation) / max(1, |optimum|); absent without a proven optimum
    std::optional<double> gap = {};
    bool is_strip = false;
    /// Whether the relaxation has no fractional value; absent without a proven optimum
    std::optional<bool> is_integral = {};

    [[nodiscard]] std::string form() const {
        return is_strip ? "strip" : std::string(to_string(backend.formulation));
    }
};

/// Adds size and relaxation of the program.
void measure_program(const BinaryProgram& program, ProgramRow& row) {
    row.columns = program.columns.size();
    row.rows = program.rows.size();
    row.entries = program.entry_values.size();
    if (!row.is_optimal()) return;
    if (const auto relaxed = linear_relaxation(program)) {
        row.gap = (*row.objective - relaxed->optimum) / std::max(1.0, std::abs(*row.objective));
        row.is_integral = relaxed->is_integral;
    }
}

ProgramRow with_program(SolveRow solve, const RldParameters& parameters) {
    const Formulation formulation = solve.backend.formulation;
    const LaneGraphModel model(
        make_problem(cones_of(*solve.scene, solve.size), parameters, parts(formulation).extent), formulation);
    ProgramRow row{std::move(solve)};
    measure_program(model.program(), row);
    return row;
}

/// The strip program with its hand-set costs on the same cones, by its own search and by every
/// backend. Throws InvalidInput naming the scene where two optima differ.
std::vector<ProgramRow> strip_rows(const SolveRow& cones, double time_limit_ms) {
    const StripParameters parameters = driving_strip_parameters();
    const Scene scene = cones_of(*cones.scene, cones.size);
    std::vector<ProgramRow> rows;
    const auto add = [&](std::string_view solver, const auto& solve) {
        ProgramRow row;
        row.scene = cones.scene;
        row.size = cones.size;
        row.backend.solver = solver;
        row.is_strip = true;
        const Stopwatch watch;
        const StripProblem problem = make_strip_problem(scene, parameters);
        row.build_ms = watch.elapsed_ms();
        const StripReport report = solve(problem);
        row.latency_ms = watch.elapsed_ms();
        row.build_ms += report.build_ms;
        if (report.status == SolveStatus::error) throw InvalidInput(cones.scene->scene.id, report.message);
        row.status = report.status;
        row.objective = report.objective;
        row.nodes = report.nodes;
        StripModel model(problem);
        if (!model.build(Deadline())) measure_program(model.program(), row);
        if (row.is_optimal() && !rows.empty() && rows.front().is_optimal() &&
            std::abs(*row.objective - *rows.front().objective) > kObjectiveTolerance)
            throw InvalidInput(cones.scene->scene.id, fmt::format("strip-search and {} differ", solver));
        rows.push_back(std::move(row));
    };
    StripSolver search;
    add("strip-search", [&](const StripProblem& problem) {
        return search.solve(problem, {.limits = {.time_limit_ms = time_limit_ms}});
    });
    for (const MilpBackend& backend : milp_backends()) {
        add(backend.entry.name, [&](const StripProblem& problem) {
            return solve_strip_by_milp(backend, problem, {.time_limit_ms = time_limit_ms});
        });
    }
    return rows;
}

/// Throws InvalidInput naming the scene where the formulations have different optima.
void require_same_optima(const std::vector<ProgramRow>& rows) {
    std::map<std::pair<std::size_t, const AnnotatedScene*>, double> optima;
    for (const ProgramRow& row : rows) {
        if (!row.is_optimal()) continue;
        const auto [known, is_new] = optima.emplace(std::pair(row.size, row.scene), *row.objective);
        if (std::abs(known->second - *row.objective) > kObjectiveTolerance) {
            throw InvalidInput(row.scene->scene.id, fmt::format("the optima differ: tight {}, paper {}",
                                                                known->second, *row.objective));
        }
    }
}

class FormulationsStudy : public SolveStudy {
  public:
    FormulationsStudy()
        : SolveStudy(
              {"formulations",
               "what does the tight formulation gain over the printed one: size, LP gap, nodes, time?",
               "The nearest cones of each scene that has as many; the tight formulation by cbc, the printed "
               "one by cbc-main, each the faster of the two on it; one thread. Times are wall clock with "
               "the making of the program. LP gap: (optimum - relaxation) / max(1, |optimum|), over the "
               "scenes with a proven optimum. The optima of both must be the same."},
              {.backends = {{"cbc"}, {"cbc-main", Formulation::paper}},
               .sizes = {6, 8, 10, 12, 16, 20, 24, 30},
               .time_limit_ms = 10'000.0}) {}

    void add_options(CLI::App& command) override {
        SolveStudy::add_options(command);
        command.add_flag(
            "--strip", with_strip_,
            "also the strip program with its hand-set costs, by every MILP backend and its own search");
    }

  protected:
    StudyResult aggregate(const SceneSet& set, SolveOptions solves) override {
        std::vector<ProgramRow> rows;
        std::vector<ProgramRow> strips;
        for (SolveRow& row : solved_scenes(set.scenes, solves)) {
            if (with_strip_ && row.backend.formulation == Formulation::tight)
                std::ranges::move(strip_rows(row, solves.time_limit_ms), std::back_inserter(strips));
            rows.push_back(with_program(std::move(row), solves.parameters));
        }
        require_same_optima(rows);
        std::ranges::move(strips, std::back_inserter(rows));
        using Row = ProgramRow;
        using Group = RowGroup<Row>;
        const RowFields<Group> fields{
            {"cones", first_of(&Row::size)},
            {"", first_of(&Row::size_text), Shown::number("n")},
            {"formulation", first_of(&Row::form), Shown::text("form")},
            {"solver", first_of([](const Row& row) { return row.backend.solver; }), Shown::text("solver")},
            {"scenes", &Group::size, Shown::number("scenes")},
            {"optimal", count_of(&Row::is_optimal), Shown::number("optimal")},
            {"infeasible", count_of(&Row::is_infeasible), Shown::number("infeasible")},
            {"columns", mean_of(&Row::columns), Shown::fixed("columns", 0)},
            {"rows", mean_of(&Row::rows), Shown::fixed("rows", 0)},
            {"entries", mean_of(&Row::entries), Shown::fixed("entries", 0)},
            {"integral", mean_of(&Row::is_integral), Shown::percent("integral %", 1)},
            {"median_gap", median_of(&Row::gap), Shown::percent("gap med %", 2)},
            {"mean_gap", mean_of(&Row::gap), Shown::percent("gap avg %", 2)},
            {"mean_nodes", mean_of(&Row::nodes), Shown::fixed("nodes", 1)},
            {"median_build_ms", median_of(&Row::build_ms), Shown::fixed("build ms", 3)},
            {"median_ms", median_of(&Row::latency_ms), Shown::fixed("median ms", 3)},
            {"p95_ms", quantile_of(&Row::latency_ms, 0.95), Shown::fixed("p95 ms", 3)}};
        return study_result(
            groups_of<Row>(
                rows, [](const Row& row) { return std::tuple(row.size, row.form(), row.backend.solver); }),
            fields);
    }

  private:
    bool with_strip_ = false;
};

constexpr double kNeighbourhood_m = 5.5;
constexpr std::array<std::size_t, 6> kEdgeClasses{0, 100, 200, 300, 500, 1000};

struct GrowthRow : SolveRow {
    double density = 0.0;  ///< mean number of other cones within 5.5 m of a cone

    /// False: the nearest cones of a scene that has more.
    [[nodiscard]] bool all_visible() const { return size == kAllVisible; }
};
using GrowthGroup = RowGroup<GrowthRow>;

double neighbours_per_cone(const Scene& scene) {
    std::size_t pairs = 0;
    for (std::size_t i = 0; i < scene.cones.size(); ++i) {
        for (std::size_t j = i + 1; j < scene.cones.size(); ++j) {
            if ((scene.cones[i].position - scene.cones[j].position).norm() <= kNeighbourhood_m) ++pairs;
        }
    }
    return scene.cones.empty() ? 0.0
                               : 2.0 * static_cast<double>(pairs) / static_cast<double>(scene.cones.size());
}

/// A table of the groups by `key_of`, ascending.
template <typename KeyOf, typename NameOf>
std::string table_by(Shown title, const std::vector<GrowthRow>& rows, const KeyOf& key_of,
                     const NameOf& name_of) {
    std::vector<GrowthGroup> groups = groups_of<GrowthRow>(rows, key_of);
    std::ranges::sort(groups, {}, [&](const GrowthGroup& group) { return key_of(group.first()); });
    return row_table(
        groups,
        RowFields<GrowthGroup>{
            {"", [&](const GrowthGroup& group) { return name_of(*key_of(group.first())); }, std::move(title)},
            {"", &GrowthGroup::size, Shown::number("scenes")},
            {"", mean_of(&GrowthRow::cones), Shown::fixed("cones", 0)},
            {"", mean_of(&GrowthRow::edges), Shown::fixed("edges", 0)},
            {"", median_of(&GrowthRow::cpu_ms), Shown::fixed("median ms", 3)},
            {"", quantile_of(&GrowthRow::cpu_ms, 0.95), Shown::fixed("p95 ms", 3)},
            {"", quantile_of(&GrowthRow::cpu_ms, 1.0), Shown::fixed("max ms", 1)},
            {"", mean_of(&GrowthRow::nodes), Shown::fixed("nodes", 2)},
            {"", share_of(&GrowthRow::is_proven), Shown::percent("proven %", 1)}});
}

std::string tables_of(const std::vector<GrowthRow>& rows) {
    const auto of_all = [](auto key_of) {
        return [key_of](const GrowthRow& row) {
            return row.all_visible() ? std::optional(key_of(row)) : std::nullopt;
        };
    };
    const auto itself = [](const auto& key) { return key; };
    const auto cones = [](const GrowthRow& row) {
        return row.all_visible() ? std::nullopt : std::optional(row.cones);
    };
    const auto density = of_all([](const GrowthRow& row) { return static_cast<std::size_t>(row.density); });
    const auto range = [](std::size_t key) { return fmt::format("{}-{}", key, key + 1); };
    const auto edges =
        of_all([](const GrowthRow& row) { return *(std::ranges::upper_bound(kEdgeClasses, row.edges) - 1); });
    const auto course = of_all([](const GrowthRow& row) { return row.scene->track; });
    return table_by(Shown::number("nearest"), rows, cones, itself) + "\nAll visible cones:\n" +
           table_by(Shown::number("density"), rows, density, range) + "\n" +
           table_by(Shown::number("edges from"), rows, edges, itself) + "\n" +
           table_by(Shown::text("course"), rows, course, itself);
}

class GrowthStudy : public SolveStudy {
  public:
    GrowthStudy()
        : SolveStudy(
              {"growth", "how does the cost of path-pair grow with the cones and their density?",
               "Each scene's nearest cones at each size that it exceeds, and all its cones. Processor "
               "time of the one thread, from the scene in memory to the answer in memory; the limit is "
               "of wall clock. Density: how many others a cone has within 5.5 m, on average."},
              {.backends = {{"path-pair"}}, .sizes = {12, 20, 30, 40, 60, 80, 120}}) {}

  protected:
    StudyResult aggregate(const SceneSet& set, SolveOptions solves) override {
        const std::vector<AnnotatedScene> scenes = spread(set.scenes, solves.limit);
        solves.limit.reset();
        std::erase(solves.sizes, kAllVisible);
        solves.sizes.push_back(kAllVisible);
        solves.wanted = [](const AnnotatedScene& scene, std::size_t size) {
            return size < scene.scene.cones.size();
        };
        std::vector<GrowthRow> rows;
        for (SolveRow& row : solved_scenes(scenes, solves)) {
            const double density = neighbours_per_cone(cones_of(*row.scene, row.size));
            rows.push_back({std::move(row), density});
        }
        std::ranges::stable_sort(rows, {}, &SolveRow::scene);
        StudyResult result{tables_of(rows)};
        result.add_rows(rows, with_scene<GrowthRow>({{"cones", &SolveRow::cones},
                                                     {"all_visible", &GrowthRow::all_visible},
                                                     {"density", &GrowthRow::density},
                                                     {"edges", &SolveRow::edges},
                                                     {"proven", &SolveRow::is_proven},
                                                     {"nodes", &SolveRow::nodes},
                                                     {"cpu_ms", &SolveRow::cpu_ms}}));
        return result;
    }
};

constexpr std::string_view kExact = "path-pair";

std::optional<std::size_t> nearest_of(std::size_t size) {
    return size == kAllVisible ? std::nullopt : std::optional(size);
}

/// A solve beside the proven least cost. Without an answer, it is inaccurate and counts with its time.
struct RelaxedRow : SolveRow {
    bool is_accurate = false;          ///< RLD paper, IV-B
    std::optional<double> least = {};  ///< absent where path-pair proved no optimum
    std::optional<double> gap = {};    ///< (objective - least) / max(1, |least|), of an answer

    [[nodiscard]] bool is_best() const { return gap && *objective <= *least + kObjectiveTolerance; }
};

bool is_accurate(const SolveRow& row) {
    LaneAnswer answer;
    if (row.lane_graph) {
        if (const std::optional<Lane> lane = to_lane(*row.lane_graph, cones_of(*row.scene, row.size))) {
            answer.status = LaneStatus::found;
            answer.lane = *lane;
        }
    }
    return score(*row.scene, answer, row.latency_ms, nearest_of(row.size), nullptr).accurate();
}

/// Throws InvalidInput naming the scene where a solver answers below the least cost.
std::vector<RelaxedRow> relaxed(std::vector<SolveRow> solves) {
    std::map<std::pair<std::size_t, const AnnotatedScene*>, double> least;
    std::vector<RelaxedRow> rows;
    for (SolveRow& solve : solves) {
        if (solve.status == SolveStatus::error && solve.backend.solver == kExact)
            throw InvalidInput(solve.scene->scene.id, solve.message);
        const bool accurate = is_accurate(solve);
        RelaxedRow& row = rows.emplace_back(RelaxedRow{std::move(solve), accurate});
        const std::pair key(row.size, row.scene);
        if (row.is_optimal() && row.backend.solver == kExact) least[key] = *row.objective;
        if (row.is_optimal()) row.least = row.objective;
        if (const auto known = least.find(key); !row.least && known != least.end()) row.least = known->second;
        if (!row.least || !row.objective) continue;
        if (*row.objective < *row.least - kObjectiveTolerance) {
            throw InvalidInput(row.scene->scene.id,
                               fmt::format("{} answers {}, below the least cost {}", row.backend.solver,
                                           *row.objective, *row.least));
        }
        row.gap = relative_gap(*row.objective, *row.least);
    }
    return rows;
}

class RelaxationsStudy : public SolveStudy {
  public:
    RelaxationsStudy()
        : SolveStudy(
              {"relaxations",
               "does relaxing the binary constraints decrease latency (RLD paper, V), and what does it "
               "cost in accuracy?",
               "The nearest cones of each scene that has enough cones and a ground truth among them; "
               "every solver that proves nothing, and path-pair, which gives the optimum; one thread. "
               "Times are wall clock, including making the problem. Gap: (objective - optimum) / "
               "max(1, |optimum|), over the answers."},
              {.sizes = {8, 12, 16, 20, 30}, .time_limit_ms = kRealTimeLimit_ms}) {}

  protected:
    StudyResult aggregate(const SceneSet& set, SolveOptions solves) override {
        solves.backends = {{std::string(kExact)}};
        for (const RldSolverEntry& entry : rld_solvers()) {
            if (!entry.has(SolverTrait::exact)) solves.backends.push_back({std::string(entry.name)});
        }
        solves.wanted = [](const AnnotatedScene& scene, std::size_t size) {
            return has_cones(scene, size) && counts(scene) &&
                   (size == kAllVisible || ground_truth_of_nearest(scene, size).has_value());
        };
        std::vector<SolveRow> solved = solve_scenes(set.scenes, solves).rows;
        AnswerErrors errors = errors_among(solved);
        const std::vector<RelaxedRow> rows = relaxed(std::move(solved));
        using Row = RelaxedRow;
        using Group = RowGroup<Row>;
        const auto share_of_feasible = [](auto is) {
            return [is](const Group& group) { return share(group.count(is), group.count(&Row::least)); };
        };
        const auto solver = [](const Row& row) { return row.backend.solver; };
        const RowFields<Group> fields{
            {"cones", first_of(&Row::size)},
            {"", first_of(&Row::size_text), Shown::number("n")},
            {"solver", first_of(solver), Shown::text("solver")},
            {"scenes", &Group::size, Shown::number("scenes")},
            {"feasible", count_of(&Row::least), Shown::number("feasible")},
            {"answered", count_of(&Row::gap)},
            {"", share_of_feasible(&Row::gap), Shown::percent("answered %", 2)},
            {"optimal", count_of(&Row::is_best)},
            {"", share_of_feasible(&Row::is_best), Shown::percent("optimal %", 2)},
            {"mean_gap", mean_of(&Row::gap), Shown::percent("gap avg %", 2)},
            {"worst_gap", quantile_of(&Row::gap, 1.0), Shown::percent("gap worst %", 2)},
            {"accurate", share_of(&Row::is_accurate), Shown::percent("accurate %", 2)},
            {"median_ms", median_of(&Row::latency_ms), Shown::fixed("median ms", 3)},
            {"p95_ms", quantile_of(&Row::latency_ms, 0.95), Shown::fixed("p95 ms", 3)},
            {"worst_ms", quantile_of(&Row::latency_ms, 1.0), Shown::fixed("worst ms", 3)}};
        StudyResult result = study_result(
            groups_of<Row>(rows, [&](const Row& row) { return std::pair(row.size, solver(row)); }), fields);
        result.errors = std::move(errors);
        return result;
    }
};

}  // namespace

std::unique_ptr<Study> make_formulations_study() {
    return std::make_unique<FormulationsStudy>();
}

std::unique_ptr<Study> make_growth_study() {
    return std::make_unique<GrowthStudy>();
}

std::unique_ptr<Study> make_relaxations_study() {
    return std::make_unique<RelaxationsStudy>();
}

}  // namespace conelane::experiments
