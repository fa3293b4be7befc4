#include "experiments/comparison/optimality.hpp"

#include "experiments/comparison/answer_check.hpp"
#include "experiments/comparison/runner.hpp"
#include "experiments/files/figure_file.hpp"
#include "experiments/files/json_node.hpp"
#include "experiments/methods.hpp"
#include "experiments/progress.hpp"
#include "experiments/scoring/statistics.hpp"
#include "model/check.hpp"
#include "model/invalid_input.hpp"
#include "model/lane_graph_problem.hpp"
#include "solvers/registry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

namespace conelane::experiments {
namespace {

/// Objectives this close are the same: what a solver's answer may be off, see SolveLimits.
constexpr double kAgreement = 1e-6;

/// One lap with the state that a method carries along it.
class Lap {
  public:
    Lap(const TrackBoundariesByName& tracks, const OptimalityOptions& options)
        : tracks_(tracks),
          options_(options),
          solver_(find_rld_solver("path-pair")->make(Formulation::tight)),
          detector_(make_detector(find_method(options.method), {options.parameters, {}, options.nearest})) {}

    OptimalityRow drive(const AnnotatedScene& annotated) {
        const Scene cones =
            options_.nearest ? nearest_ahead(annotated.scene, *options_.nearest) : annotated.scene;
        const LaneGraphProblem problem = make_problem(cones, options_.parameters, solver_->extent());
        OptimalityRow row;
        row.scene = &annotated;
        solve(row, problem, cones);
        const LaneAnswer answer =
            detector_->detect(annotated.scene, {std::numeric_limits<double>::infinity(), true});
        if (!answer.enumeration) throw InvalidInput("method", "'" + options_.method + "' does not enumerate");
        if (answer.status == LaneStatus::found) row.choice = priced(answer.lane, problem, cones, annotated);
        price_candidates(row, answer.enumeration->candidates, problem, cones);
        return row;
    }

  private:
    void solve(OptimalityRow& row, const LaneGraphProblem& problem, const Scene& cones) {
        const RldReport report = solver_->solve(problem, {options_.time_limit_ms});
        row.status = report.status;
        row.bound = report.bound;
        if (!report.lane_graph) return;
        const Claim claim{report.status == SolveStatus::optimal, *report.objective, report.bound};
        require_accepted(check(cones, options_.parameters, *report.lane_graph, claim), cones.id, "optimum");
        if (const auto lane = to_lane(*report.lane_graph, cones)) {
            row.optimum = judged(*lane, *row.scene);
            row.optimum->objective = report.objective;
        }
    }

    void price_candidates(OptimalityRow& row, const std::vector<LaneCandidate>& candidates,
                          const LaneGraphProblem& problem, const Scene& cones) const {
        std::set<std::vector<Edge>> met;
        const Lane* cheapest = nullptr;
        double least = 0.0;
        for (const LaneCandidate& candidate : candidates) {
            const auto graph = lane_graph_of(candidate.lane, cones);
            if (!graph || !met.insert(graph->edges).second) continue;
            ++row.candidates;
            if (!is_feasible(problem, *graph)) continue;
            ++row.feasible;
            const double price = objective(problem, *graph);
            if (cheapest != nullptr && price >= least) continue;
            cheapest = &candidate.lane;
            least = price;
        }
        if (cheapest == nullptr) return;
        require_accepted(
            check(cones, options_.parameters, *lane_graph_of(*cheapest, cones), {false, least, {}}), cones.id,
            "candidate");
        if (row.status == SolveStatus::infeasible) {
            throw InvalidInput(cones.id, "a candidate is feasible where none was proven to be");
        }
        if (row.status == SolveStatus::optimal && least < *row.optimum->objective - kAgreement) {
            throw InvalidInput(cones.id, fmt::format("a candidate costs {}, less than the proven optimum {}",
                                                     least, *row.optimum->objective));
        }
        row.candidate = judged(*cheapest, *row.scene);
        row.candidate->objective = least;
    }

    [[nodiscard]] PricedLane priced(const Lane& lane, const LaneGraphProblem& problem, const Scene& cones,
                                    const AnnotatedScene& annotated) const {
        PricedLane result = judged(lane, annotated);
        const auto graph = lane_graph_of(lane, cones);
        if (graph && is_feasible(problem, *graph)) result.objective = objective(problem, *graph);
        return result;
    }

    [[nodiscard]] PricedLane judged(const Lane& lane, const AnnotatedScene& annotated) const {
        const auto track = tracks_.find(annotated.track);
        LaneAnswer answer;
        answer.status = LaneStatus::found;
        answer.lane = lane;
        const SceneScore result = score(annotated, answer, 0.0, options_.nearest,
                                        track == tracks_.end() ? nullptr : &track->second);
        return {{}, result.category, result.iou};
    }

    static void require_accepted(const CheckReport& report, const std::string& scene, const char* what) {
        if (report.violations.empty()) return;
        throw InvalidInput(scene, fmt::format("the checker rejects the {}: {}", what, report.violations[0]));
    }

    const TrackBoundariesByName& tracks_;
    const OptimalityOptions& options_;
    std::unique_ptr<RldSolver> solver_;
    std::unique_ptr<LaneDetector> detector_;
};

nlohmann::ordered_json to_json(const PricedLane& lane) {
    nlohmann::ordered_json json{{"category", to_string(lane.category)}, {"iou", lane.iou}};
    if (lane.objective) json["objective"] = *lane.objective;
    return json;
}

std::string percent(std::size_t part, std::size_t whole) {
    return whole == 0 ? "-"
                      : fmt::format("{:.1f}", 100.0 * static_cast<double>(part) / static_cast<double>(whole));
}

}  // namespace

std::optional<double> OptimalityRow::gap() const {
    if (status != SolveStatus::optimal || !candidate) return std::nullopt;
    const double least = *optimum->objective;
    return std::max(0.0, *candidate->objective - least) / std::max(1.0, std::abs(least));
}

bool OptimalityRow::is_optimal() const {
    return gap() && *candidate->objective - *optimum->objective <= kAgreement;
}

std::vector<OptimalityRow> optimality_rows(std::span<const AnnotatedScene> scenes,
                                           const TrackBoundariesByName& tracks,
                                           const OptimalityOptions& options) {
    (void)find_method(options.method);
    const std::vector<std::size_t> starts = lap_starts(scenes);
    std::vector<OptimalityRow> rows(scenes.size());
    Progress progress("optimality", scenes.size());
    oneapi::tbb::task_arena arena(
        std::min(static_cast<int>(options.threads), oneapi::tbb::info::default_concurrency()));
    arena.execute([&] {
        oneapi::tbb::parallel_for(std::size_t{0}, starts.size() - 1, [&](std::size_t lap) {
            Lap driven(tracks, options);
            for (std::size_t i = starts[lap]; i < starts[lap + 1]; ++i) {
                if (counts(scenes[i])) rows[i] = driven.drive(scenes[i]);
                progress.advance();
            }
        });
    });
    std::erase_if(rows, [](const OptimalityRow& row) { return row.scene == nullptr; });
    return rows;
}

std::string optimality_table(std::span<const OptimalityRow> rows) {
    struct Sums {
        std::size_t scenes = 0, proven = 0, candidates = 0, feasible = 0, compared = 0, equal = 0;
        std::size_t optimum_successes = 0, candidate_successes = 0;
        std::vector<double> gaps, optimum_ious, candidate_ious;
    };
    std::map<std::optional<double>, Sums> by_rate;
    for (const OptimalityRow& row : rows) {
        Sums& sums = by_rate[row.scene->false_positive_rate];
        ++sums.scenes;
        sums.candidates += row.candidates;
        sums.feasible += row.feasible;
        if (row.status == SolveStatus::optimal) ++sums.proven;
        const auto gap = row.gap();
        if (!gap) continue;
        ++sums.compared;
        sums.gaps.push_back(*gap);
        if (row.is_optimal()) ++sums.equal;
        if (is_success(row.optimum->category)) ++sums.optimum_successes;
        if (is_success(row.candidate->category)) ++sums.candidate_successes;
        sums.optimum_ious.push_back(row.optimum->iou);
        sums.candidate_ious.push_back(row.candidate->iou);
    }
    std::string table =
        fmt::format("{:>5} {:>7} {:>8} {:>22} {:>9} {:>7} {:>13} {:>11} {:>22} {:>18}\n", "fp %", "scenes",
                    "proven %", "feasible candidates %", "compared", "equal %", "median gap %", "p95 gap %",
                    "success % opt / cand", "IoU % opt / cand");
    for (const auto& [rate, sums] : by_rate) {
        const bool any = sums.compared > 0;
        table += fmt::format("{:>5} {:>7} {:>8} {:>22} {:>9} {:>7} {:>13} {:>11} {:>22} {:>18}\n",
                             rate ? fmt::format("{:.1f}", 100.0 * *rate) : "-", sums.scenes,
                             percent(sums.proven, sums.scenes), percent(sums.feasible, sums.candidates),
                             sums.compared, percent(sums.equal, sums.compared),
                             any ? fmt::format("{:.3f}", 100.0 * median(sums.gaps)) : "-",
                             any ? fmt::format("{:.3f}", 100.0 * quantile(sums.gaps, 0.95)) : "-",
                             percent(sums.optimum_successes, sums.compared) + " / " +
                                 percent(sums.candidate_successes, sums.compared),
                             any ? fmt::format("{:.1f} / {:.1f}", 100.0 * mean(sums.optimum_ious),
                                               100.0 * mean(sums.candidate_ious))
                                 : "-");
    }
    return table;
}

void write_optimality_rows(const std::filesystem::path& file, std::span<const OptimalityRow> rows,
                           const OptimalityOptions& options) {
    FigureFile output(file);
    for (const OptimalityRow& row : rows) {
        const AnnotatedScene& scene = *row.scene;
        nlohmann::ordered_json json{{"scene", scene.scene.id}, {"track", scene.track}};
        if (scene.false_positive_rate) json["false_positive_rate"] = *scene.false_positive_rate;
        if (scene.range_m) json["range"] = *scene.range_m;
        json["method"] = options.method;
        if (options.nearest) json["nearest"] = *options.nearest;
        json["status"] = to_string(row.status);
        if (row.bound) put_bound(json, *row.bound, "bound");
        json["candidates"] = row.candidates;
        json["feasible_candidates"] = row.feasible;
        if (row.optimum) json["optimum"] = to_json(*row.optimum);
        if (row.candidate) json["candidate"] = to_json(*row.candidate);
        if (row.choice) json["choice"] = to_json(*row.choice);
        if (const auto gap = row.gap()) {
            json["gap"] = *gap;
            json["equal"] = row.is_optimal();
        }
        output.add(std::move(json));
    }
    output.commit();
}

}  // namespace conelane::experiments
