#include "experiments/studies/growth.hpp"

#include "conelane/invalid_input.hpp"
#include "conelane/lane_graph_problem.hpp"
#include "conelane/solve_scene.hpp"
#include "evaluation/formats/scene_file.hpp"
#include "evaluation/scoring/statistics.hpp"
#include "experiments/options/whole_number.hpp"
#include "experiments/progress/progress.hpp"
#include "experiments/studies/study.hpp"
#include "experiments/studies/study_options.hpp"
#include "experiments/studies/text_table.hpp"
#include "solvers/registry.hpp"

#include <algorithm>
#include <array>
#include <ctime>
#include <functional>
#include <map>
#include <utility>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

constexpr double kNeighbourhood_m = 5.5;
constexpr std::array<std::size_t, 6> kEdgeClasses{0, 100, 200, 300, 500, 1000};

/// Processor time, so that other programs do not count.
double thread_cpu_ms() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

GrowthRow solve(const AnnotatedScene& scene, const Scene& cones, RldSolver& solver,
                const GrowthOptions& options) {
    GrowthRow row;
    row.scene = &scene;
    row.cones = cones.cones.size();
    row.all_visible = row.cones == scene.scene.cones.size();
    row.density = neighbours_per_cone(cones);
    const double begin_ms = thread_cpu_ms();
    const SolvedScene solved =
        solve_scene(solver, cones, options.parameters, {.limits = {options.time_limit_ms}});
    row.cpu_ms = thread_cpu_ms() - begin_ms;
    const RldReport& report = solved.report;
    if (report.status == SolveStatus::error) throw InvalidInput(cones.id, report.message);
    row.edges =
        static_cast<std::size_t>(std::ranges::count(solved.problem.edges, false, &ProblemEdge::high_cost));
    row.proven = report.status == SolveStatus::optimal || report.status == SolveStatus::infeasible;
    row.nodes = report.nodes;
    return row;
}

/// A table of groups of rows, in the order of their keys.
template <typename Key>
std::string table_by(const std::string& title, bool is_text, std::span<const GrowthRow> rows,
                     const std::function<std::optional<Key>(const GrowthRow&)>& key_of,
                     const std::function<std::string(const Key&)>& name_of) {
    std::map<Key, std::vector<const GrowthRow*>> groups;
    for (const GrowthRow& row : rows) {
        if (const std::optional<Key> key = key_of(row)) groups[*key].push_back(&row);
    }
    TextTable table({{title, is_text},
                     {"scenes"},
                     {"cones"},
                     {"edges"},
                     {"median ms"},
                     {"p95 ms"},
                     {"max ms"},
                     {"nodes"},
                     {"proven %"}});
    for (const auto& [key, group] : groups) {
        std::vector<double> times;
        double cones = 0.0;
        double edges = 0.0;
        double nodes = 0.0;
        std::size_t proven = 0;
        for (const GrowthRow* row : group) {
            times.push_back(row->cpu_ms);
            cones += static_cast<double>(row->cones);
            edges += static_cast<double>(row->edges);
            nodes += static_cast<double>(row->nodes);
            proven += row->proven ? 1 : 0;
        }
        const auto count = static_cast<double>(group.size());
        table.add({name_of(key), std::to_string(group.size()), fixed(cones / count, 0),
                   fixed(edges / count, 0), fixed(median(times), 3), fixed(quantile(times, 0.95), 3),
                   fixed(quantile(times, 1.0), 1), fixed(nodes / count, 2),
                   percent(share(proven, group.size()), 1)});
    }
    return table.text();
}

std::size_t edge_class(std::size_t edges) {
    return *(std::ranges::upper_bound(kEdgeClasses, edges) - 1);
}

nlohmann::ordered_json row_to_json(const GrowthRow& row) {
    nlohmann::ordered_json json{
        {"scene", row.scene->scene.id},   {"track", row.scene->track}, {"cones", row.cones},
        {"all_visible", row.all_visible}, {"density", row.density},    {"edges", row.edges},
        {"proven", row.proven},           {"nodes", row.nodes},        {"cpu_ms", row.cpu_ms}};
    return json;
}

class GrowthStudy : public Study {
  public:
    GrowthStudy()
        : Study({"growth", "how does the cost of path-pair grow with the cones and their density?",
                 "Each scene's nearest cones at each size that it exceeds, and all its cones. Processor time "
                 "of "
                 "the one thread, from the scene in memory to the answer in memory; the limit is of wall "
                 "clock. "
                 "Density: how many others a cone has within 5.5 m, on average."}) {}

    void add_options(CLI::App& command) override {
        add_input_options(command, input_);
        add_sizes_option(command, options_.sizes);
        command
            .add_option_function<std::size_t>(
                "--limit", [this](std::size_t count) { options_.limit = count; },
                "scenes at most, evenly spread")
            ->check(whole_number(1, 1'000'000));
        add_time_limit_option(command, options_.time_limit_ms);
    }

    StudyResult run() override {
        options_.parameters = input_.parameters.load();
        const std::vector<AnnotatedScene> scenes = read_scenes(input_.scenes);
        const std::vector<GrowthRow> rows = growth_rows(scenes, options_);
        return study_result(growth_tables(rows), rows, [](const GrowthRow& row) { return row_to_json(row); });
    }

  private:
    StudyInput input_;
    GrowthOptions options_;
};

}  // namespace

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

std::vector<GrowthRow> growth_rows(std::span<const AnnotatedScene> scenes, const GrowthOptions& options) {
    const std::unique_ptr<RldSolver> solver = find_rld_solver("path-pair")->make(Formulation::tight);
    const std::size_t count = std::min(options.limit.value_or(scenes.size()), scenes.size());
    std::vector<GrowthRow> rows;
    Progress progress("growth", count);
    for (std::size_t k = 0; k < count; ++k) {
        const AnnotatedScene& scene = scenes[k * scenes.size() / count];
        if (k == 0) (void)solve(scene, scene.scene, *solver, options);  // loads code before times are taken
        for (const std::size_t size : options.sizes) {
            if (size < scene.scene.cones.size())
                rows.push_back(solve(scene, nearest_ahead(scene.scene, size), *solver, options));
        }
        rows.push_back(solve(scene, scene.scene, *solver, options));
        progress.advance();
    }
    return rows;
}

std::string growth_tables(std::span<const GrowthRow> rows) {
    const auto all_visible = [](const GrowthRow& row, auto key) {
        return row.all_visible ? std::optional(key) : std::nullopt;
    };
    const auto number = [](const std::size_t& key) { return std::to_string(key); };
    return table_by<std::size_t>(
               "nearest", false, rows,
               [](const GrowthRow& row) { return row.all_visible ? std::nullopt : std::optional(row.cones); },
               number) +
           "\nAll visible cones:\n" +
           table_by<std::size_t>(
               "density", false, rows,
               [&](const GrowthRow& row) { return all_visible(row, static_cast<std::size_t>(row.density)); },
               [](const std::size_t& key) { return fmt::format("{}-{}", key, key + 1); }) +
           "\n" +
           table_by<std::size_t>(
               "edges from", false, rows,
               [&](const GrowthRow& row) { return all_visible(row, edge_class(row.edges)); }, number) +
           "\n" +
           table_by<std::string>(
               "course", true, rows, [&](const GrowthRow& row) { return all_visible(row, row.scene->track); },
               [](const std::string& key) { return key; });
}

std::unique_ptr<Study> make_growth_study() {
    return std::make_unique<GrowthStudy>();
}

}  // namespace conelane::experiments
