#include "experiments/studies/features.hpp"

#include "conelane/solve_scene.hpp"
#include "evaluation/formats/scene_file.hpp"
#include "evaluation/scoring/statistics.hpp"
#include "experiments/progress/progress.hpp"
#include "experiments/studies/study.hpp"
#include "experiments/studies/study_options.hpp"
#include "experiments/studies/text_table.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

nlohmann::ordered_json to_json(const FeatureRow& row) {
    nlohmann::ordered_json json{
        {"scene", row.scene->scene.id}, {"track", row.scene->track}, {"nearest", row.cones}};
    for (const NamedFeature& feature : named(row.features)) {
        if (std::isfinite(feature.value)) json[std::string(feature.name)] = feature.value;
    }
    json["problem_ms"] = row.features.problem_ms;
    json["relaxation_ms"] = row.features.relaxation_ms;
    json["solve_ms"] = row.solve_ms;
    if (row.lp_gap) json["lp_gap"] = *row.lp_gap;
    return json;
}

class FeaturesStudy : public Study {
  public:
    FeaturesStudy()
        : Study({"features", "what do instances look like, and what does it cost to know?",
                 "Features of the problem (cones, candidate edges, conflicts) and of the tight program's "
                 "linear "
                 "relaxation by Clp (size, fractional edges, degeneracy), each group timed on its own, one "
                 "thread. The gap of the relaxation needs the optimum, by path-pair, so it is not a "
                 "feature."}) {}

    void add_options(CLI::App& command) override {
        options_.sizes = {12, 20, 30};
        options_.time_limit_ms = 10'000.0;
        add_input_options(command, input_);
        add_cone_set_options(command, options_);
    }

    StudyResult run() override {
        options_.parameters = input_.parameters.load();
        const std::vector<AnnotatedScene> scenes = read_scenes(input_.scenes);
        const std::vector<FeatureRow> rows = feature_rows(scenes, options_);
        return study_result(feature_table(rows), rows, [](const FeatureRow& row) { return to_json(row); });
    }

  private:
    StudyInput input_;
    ConeSetOptions options_;
};

}  // namespace

std::vector<FeatureRow> feature_rows(std::span<const AnnotatedScene> scenes, const ConeSetOptions& options) {
    const std::unique_ptr<RldSolver> solver = make_path_pair_solver();
    std::vector<FeatureRow> rows;
    for (const std::size_t size : options.sizes) {
        const auto wanted =
            scenes_of_size(scenes, size, options.limit, [](const AnnotatedScene&) { return true; });
        Progress progress(fmt::format("features n={}", size), wanted.size());
        for (const AnnotatedScene* const scene : wanted) {
            const Scene cones = nearest_ahead(scene->scene, size);
            FeatureRow row{scene, size, features_of(cones, options.parameters), 0.0, {}};
            const auto [problem, report, total_ms] =
                solve_scene(*solver, cones, options.parameters, {.limits = {options.time_limit_ms}});
            row.solve_ms = total_ms;
            if (report.status == SolveStatus::optimal && row.features.relaxation)
                row.lp_gap = std::max(0.0, *report.objective - row.features.relaxation->optimum) /
                             std::max(1.0, std::abs(*report.objective));
            rows.push_back(std::move(row));
            progress.advance();
        }
    }
    return rows;
}

std::string feature_table(std::span<const FeatureRow> rows) {
    TextTable table({{"n"},
                     {"scenes"},
                     {"edges"},
                     {"density %"},
                     {"conflicts"},
                     {"density %"},
                     {"LP gap %"},
                     {"fractional %"},
                     {"degenerate %"},
                     {"problem ms"},
                     {"LP ms"},
                     {"path-pair ms"}});
    std::map<std::size_t, std::vector<const FeatureRow*>> by_size;
    for (const FeatureRow& row : rows) by_size[row.cones].push_back(&row);
    for (const auto& [size, of_size] : by_size) {
        const auto of =
            [&of_size = of_size](
                const std::function<std::optional<double>(const FeatureRow&)>& get) -> std::optional<double> {
            std::vector<double> values;
            for (const FeatureRow* row : of_size) {
                if (const auto value = get(*row)) values.push_back(*value);
            }
            return values.empty() ? std::nullopt : std::optional(median(values));
        };
        using Row = FeatureRow;
        const auto relaxation = [&](double InstanceFeatures::Relaxation::*member) {
            return of([member](const Row& row) -> std::optional<double> {
                if (!row.features.relaxation) return std::nullopt;
                return (*row.features.relaxation).*member;
            });
        };
        table.add(
            {std::to_string(size), std::to_string(of_size.size()),
             fixed(of([](const Row& row) { return static_cast<double>(row.features.problem.edges); }), 0),
             percent(of([](const Row& row) { return row.features.problem.edge_density; }), 1),
             fixed(of([](const Row& row) { return static_cast<double>(row.features.problem.conflicts); }), 0),
             percent(of([](const Row& row) { return row.features.problem.conflict_density; }), 1),
             percent(of([](const Row& row) { return row.lp_gap; }), 2),
             percent(relaxation(&InstanceFeatures::Relaxation::fractional), 1),
             percent(relaxation(&InstanceFeatures::Relaxation::degenerate), 1),
             fixed(of([](const Row& row) { return row.features.problem_ms; }), 3),
             fixed(of([](const Row& row) { return row.features.relaxation_ms; }), 3),
             fixed(of([](const Row& row) { return row.solve_ms; }), 3)});
    }
    return table.text();
}

std::unique_ptr<Study> make_features_study() {
    return std::make_unique<FeaturesStudy>();
}

}  // namespace conelane::experiments
