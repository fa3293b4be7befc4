#include "experiments/options/shared_options.hpp"
#include "experiments/studies/solve_study.hpp"
#include "experiments/studies/study.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

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

}  // namespace

std::unique_ptr<Study> make_growth_study() {
    return std::make_unique<GrowthStudy>();
}

}  // namespace conelane::experiments
