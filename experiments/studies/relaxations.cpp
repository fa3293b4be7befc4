#include "conelane/invalid_input.hpp"
#include "evaluation/scoring/score.hpp"
#include "evaluation/world/ground_truth.hpp"
#include "experiments/studies/solve_study.hpp"
#include "experiments/studies/study.hpp"
#include "solvers/registry.hpp"

#include <map>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

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

std::unique_ptr<Study> make_relaxations_study() {
    return std::make_unique<RelaxationsStudy>();
}

}  // namespace conelane::experiments
