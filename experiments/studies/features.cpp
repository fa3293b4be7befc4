#include "experiments/instances/instance_features.hpp"
#include "experiments/studies/solve_study.hpp"
#include "experiments/studies/study.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace conelane::experiments {
namespace {

struct FeatureRow : SolveRow {
    InstanceFeatures features = {};
    /// (optimum - relaxation) / max(1, |optimum|); absent without a proven optimum or a relaxation
    std::optional<double> lp_gap = {};
};

RowFields<FeatureRow> fields_of_file() {
    using Row = FeatureRow;
    RowFields<Row> fields = with_scene<Row>({{"nearest", &Row::size}});
    const std::vector<NamedFeature> names = named({});
    for (std::size_t k = 0; k < names.size(); ++k) {
        fields.push_back({std::string(names[k].name), [k](const Row& row) {
                              const double value = named(row.features)[k].value;
                              return std::isfinite(value) ? std::optional(value) : std::nullopt;
                          }});
    }
    fields.push_back({"problem_ms", [](const Row& row) { return row.features.problem_ms; }});
    fields.push_back({"relaxation_ms", [](const Row& row) { return row.features.relaxation_ms; }});
    fields.push_back({"solve_ms", &Row::latency_ms});
    fields.push_back({"lp_gap", &Row::lp_gap});
    return fields;
}

class FeaturesStudy : public SolveStudy {
  public:
    FeaturesStudy()
        : SolveStudy(
              {"features", "what do instances look like, and what does it cost to know?",
               "Features of the problem (cones, candidate edges, conflicts) and of the tight program's "
               "linear relaxation by Clp (size, fractional edges, degeneracy), each group timed on its "
               "own, one thread. The gap of the relaxation needs the optimum, by path-pair, so it is "
               "not a feature."},
              {.backends = {{"path-pair"}}, .sizes = {12, 20, 30}, .time_limit_ms = 10'000.0}) {}

  protected:
    StudyResult aggregate(const SceneSet& set, SolveOptions solves) override {
        std::vector<FeatureRow> rows;
        for (SolveRow& solve : solve_scenes(set.scenes, solves).rows) {
            FeatureRow& row = rows.emplace_back(FeatureRow{std::move(solve)});
            row.features = features_of(cones_of(*row.scene, row.size), solves.parameters);
            if (row.is_optimal() && row.features.relaxation)
                row.lp_gap = std::max(0.0, *row.objective - row.features.relaxation->optimum) /
                             std::max(1.0, std::abs(*row.objective));
        }
        using Row = FeatureRow;
        using Group = RowGroup<Row>;
        const auto problem = [](auto get) {
            return median_of([get](const Row& row) { return std::invoke(get, row.features.problem); });
        };
        const auto relaxation = [](auto get) {
            return median_of([get](const Row& row) {
                const auto& relaxed = row.features.relaxation;
                return relaxed ? std::optional<double>(std::invoke(get, *relaxed)) : std::nullopt;
            });
        };
        const auto time = [](auto get) {
            return median_of([get](const Row& row) { return std::invoke(get, row.features); });
        };
        using Problem = InstanceFeatures::Problem;
        using Relaxation = InstanceFeatures::Relaxation;
        const RowFields<Group> medians{
            {"", first_of(&Row::size_text), Shown::number("n")},
            {"", &Group::size, Shown::number("scenes")},
            {"", problem(&Problem::edges), Shown::fixed("edges", 0)},
            {"", problem(&Problem::edge_density), Shown::percent("density %", 1)},
            {"", problem(&Problem::conflicts), Shown::fixed("conflicts", 0)},
            {"", problem(&Problem::conflict_density), Shown::percent("density %", 1)},
            {"", median_of(&Row::lp_gap), Shown::percent("LP gap %", 2)},
            {"", relaxation(&Relaxation::fractional), Shown::percent("fractional %", 1)},
            {"", relaxation(&Relaxation::degenerate), Shown::percent("degenerate %", 1)},
            {"", time(&InstanceFeatures::problem_ms), Shown::fixed("problem ms", 3)},
            {"", time(&InstanceFeatures::relaxation_ms), Shown::fixed("LP ms", 3)},
            {"", median_of(&Row::latency_ms), Shown::fixed("path-pair ms", 3)}};
        StudyResult result{row_table(groups_of<Row>(rows, [](const Row& row) { return row.size; }), medians)};
        result.add_rows(rows, fields_of_file());
        return result;
    }
};

}  // namespace

std::unique_ptr<Study> make_features_study() {
    return std::make_unique<FeaturesStudy>();
}

}  // namespace conelane::experiments
