#include "experiments/studies/optimality.hpp"

#include "conelane/check.hpp"
#include "conelane/invalid_input.hpp"
#include "conelane/lane_graph_problem.hpp"
#include "conelane/rld_parameter_sets.hpp"
#include "conelane/solve_scene.hpp"
#include "evaluation/formats/json_node.hpp"
#include "evaluation/formats/scene_file.hpp"
#include "evaluation/formats/scene_set.hpp"
#include "evaluation/proofs/answer_check.hpp"
#include "evaluation/scoring/statistics.hpp"
#include "experiments/methods/method.hpp"
#include "experiments/options/shared_options.hpp"
#include "experiments/options/whole_number.hpp"
#include "experiments/progress/progress.hpp"
#include "experiments/studies/cone_sets.hpp"
#include "experiments/studies/lane_graph_beam.hpp"
#include "experiments/studies/study.hpp"
#include "experiments/studies/text_table.hpp"
#include "solvers/registry.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

namespace conelane::experiments {
namespace {

std::unique_ptr<LaneDetector> made(const std::string& name, const OptimalityOptions& options) {
    const DetectorRecipe& recipe = *find_method(name).recipe;
    return make_detector(recipe, options_used_by(recipe, {{}, {}, options.nearest}));
}

constexpr DetectionLimits kWholeSearch{std::numeric_limits<double>::infinity(), true};

/// One lap with the state that detectors carry along it.
class Lap {
  public:
    Lap(const TrackBoundariesByName& tracks, const OptimalityOptions& options)
        : tracks_(tracks),
          options_(options),
          solver_(find_rld_solver("path-pair")->make(Formulation::tight)),
          detector_(made(options.detector, options)) {
        if (!options.beside.empty()) beside_ = made(options.beside, options);
    }

    /// A row for each objective.
    void drive(const AnnotatedScene& annotated, std::span<OptimalityRow> rows) {
        const Scene cones =
            options_.nearest ? nearest_ahead(annotated.scene, *options_.nearest) : annotated.scene;
        const LaneAnswer answer = detector_->detect(annotated.scene, kWholeSearch);
        if (!answer.enumeration)
            throw InvalidInput("method", "'" + options_.detector + "' does not enumerate");
        std::optional<LaneAnswer> beside;
        if (beside_) beside = beside_->detect(annotated.scene, kWholeSearch);
        for (std::size_t k = 0; k < rows.size(); ++k) {
            const NamedCosts& costs = options_.costs[k];
            OptimalityRow& row = rows[k];
            row.scene = &annotated;
            row.costs = costs.name;
            const auto [problem, report, solved_ms] =
                solve_scene(*solver_, cones, costs.parameters, {.limits = {options_.time_limit_ms}});
            if (report.status == SolveStatus::error) throw InvalidInput(cones.id, report.message);
            take_optimum(row, report, costs, cones);
            if (answer.status == LaneStatus::found)
                row.choice = with_objective(answer.lane, problem, cones, annotated);
            if (beside && beside->status == LaneStatus::found)
                row.beside = with_objective(beside->lane, problem, cones, annotated);
            compare_candidates(row, answer.enumeration->candidates, problem, cones);
            if (costs.parameters.pairing == Pairing::near_far) search_beam(row, problem, cones);
        }
    }

  private:
    void take_optimum(OptimalityRow& row, const RldReport& report, const NamedCosts& costs,
                      const Scene& cones) const {
        row.status = report.status;
        row.bound = report.bound;
        if (!report.lane_graph) return;
        const Claim claim{report.status == SolveStatus::optimal, *report.objective, report.bound};
        require_accepted(check(cones, costs.parameters, *report.lane_graph, claim), cones.id, "optimum");
        if (const auto lane = to_lane(*report.lane_graph, cones)) {
            row.optimum = judged(*lane, *row.scene);
            row.optimum->objective = report.objective;
        }
    }

    void compare_candidates(OptimalityRow& row, const std::vector<LaneCandidate>& candidates,
                            const LaneGraphProblem& problem, const Scene& cones) const {
        std::set<std::vector<Edge>> met;
        const Lane* best = nullptr;
        double least = 0.0;
        for (const LaneCandidate& candidate : candidates) {
            const auto graph = lane_graph_of(candidate.lane, cones);
            if (!graph || !met.insert(graph->edges).second) continue;
            ++row.candidates;
            if (!is_feasible(problem, *graph)) continue;
            ++row.feasible;
            const double value = objective(problem, *graph);
            if (best != nullptr && value >= least) continue;
            best = &candidate.lane;
            least = value;
        }
        if (best == nullptr) return;
        row.candidate =
            found_by_search(row, *best, *lane_graph_of(*best, cones), least, problem, cones, "candidate");
    }

    void search_beam(OptimalityRow& row, const LaneGraphProblem& problem, const Scene& cones) const {
        const auto graph = beam_lane_graph(problem, options_.beam_width);
        if (!graph) return;
        if (const auto lane = to_lane(*graph, cones))
            row.beam = found_by_search(row, *lane, *graph, objective(problem, *graph), problem, cones,
                                       "lane of the beam");
    }

    /// Throws where it contradicts the checker or what was proven.
    [[nodiscard]] JudgedLane found_by_search(const OptimalityRow& row, const Lane& lane,
                                             const LaneGraph& graph, double value,
                                             const LaneGraphProblem& problem, const Scene& cones,
                                             const char* what) const {
        require_accepted(check(cones, problem.parameters, graph, {false, value, {}}), cones.id, what);
        if (row.status == SolveStatus::infeasible) {
            throw InvalidInput(
                cones.id,
                fmt::format("a {} is feasible, but the exact search proved that there is none", what));
        }
        if (row.status == SolveStatus::optimal && value < *row.optimum->objective - kObjectiveTolerance) {
            throw InvalidInput(cones.id, fmt::format("a {} has the objective {}, below the proven optimum {}",
                                                     what, value, *row.optimum->objective));
        }
        JudgedLane result = judged(lane, *row.scene);
        result.objective = value;
        return result;
    }

    [[nodiscard]] JudgedLane with_objective(const Lane& lane, const LaneGraphProblem& problem,
                                            const Scene& cones, const AnnotatedScene& annotated) const {
        JudgedLane result = judged(lane, annotated);
        const auto graph = lane_graph_of(lane, cones);
        if (graph && is_feasible(problem, *graph)) result.objective = objective(problem, *graph);
        return result;
    }

    [[nodiscard]] JudgedLane judged(const Lane& lane, const AnnotatedScene& annotated) const {
        const auto track = tracks_.find(annotated.track);
        LaneAnswer answer;
        answer.status = LaneStatus::found;
        answer.lane = lane;
        const SceneScore result = score(annotated, answer, 0.0, options_.nearest,
                                        track == tracks_.end() ? nullptr : &track->second);
        return {{}, result.category, result.iou.value_or(0.0), result.usable()};
    }

    static void require_accepted(const CheckReport& report, const std::string& scene, const char* what) {
        if (report.violations.empty()) return;
        throw InvalidInput(scene, fmt::format("the checker rejects the {}: {}", what, report.violations[0]));
    }

    const TrackBoundariesByName& tracks_;
    const OptimalityOptions& options_;
    std::unique_ptr<RldSolver> solver_;
    std::unique_ptr<LaneDetector> detector_;
    std::unique_ptr<LaneDetector> beside_;
};

/// The lanes of a row that are compared with its optimum.
struct Rival {
    const char* name;
    std::optional<JudgedLane> OptimalityRow::*lane;
};
constexpr std::array kRivals{
    Rival{"beam", &OptimalityRow::beam}, Rival{"candidate", &OptimalityRow::candidate},
    Rival{"choice", &OptimalityRow::choice}, Rival{"beside", &OptimalityRow::beside}};

nlohmann::ordered_json to_json(const JudgedLane& lane) {
    nlohmann::ordered_json json{{"category", to_string(lane.category)}, {"iou", lane.iou}};
    if (lane.usable) json["usable"] = *lane.usable;
    if (lane.objective) json["objective"] = *lane.objective;
    return json;
}

nlohmann::ordered_json to_json(const OptimalityRow& row, const OptimalityOptions& options) {
    const AnnotatedScene& scene = *row.scene;
    nlohmann::ordered_json json{{"scene", scene.scene.id}, {"track", scene.track}};
    if (scene.false_positive_rate) json["false_positive_rate"] = *scene.false_positive_rate;
    if (scene.range_m) json["range"] = *scene.range_m;
    if (!scene.condition.empty()) json["condition"] = scene.condition;
    json["costs"] = row.costs;
    json["method"] = options.detector;
    if (!options.beside.empty()) json["method_beside"] = options.beside;
    json["beam_width"] = options.beam_width;
    if (options.nearest) json["nearest"] = *options.nearest;
    json["status"] = to_string(row.status);
    if (row.bound) put_bound(json, *row.bound, "bound");
    json["candidates"] = row.candidates;
    json["feasible_candidates"] = row.feasible;
    if (row.optimum) json["optimum"] = to_json(*row.optimum);
    for (const auto& [name, lane] : kRivals) {
        if (row.*lane) json[name] = to_json(*(row.*lane));
        if (const auto gap = row.gap_of(row.*lane)) json[name]["gap"] = *gap;
    }
    if (const auto gap = row.gap()) {
        json["gap"] = *gap;
        json["equal"] = row.is_optimal(row.candidate);
    }
    return json;
}

/// Quality of one lane a scene; no lane is neither usable nor a success.
struct Quality {
    std::size_t scenes = 0, known = 0, usable = 0, successes = 0;
    double iou_sum = 0.0;

    void add(const std::optional<JudgedLane>& lane) {
        ++scenes;
        if (!lane || lane->usable) ++known;
        if (!lane) return;
        if (lane->usable.value_or(false)) ++usable;
        if (is_success(lane->category)) ++successes;
        iou_sum += lane->iou;
    }
    /// usable / success / IoU in percent
    [[nodiscard]] std::string text() const {
        if (scenes == 0) return "-";
        return fmt::format("{} / {} / {}", percent(share(usable, known), 1),
                           percent(share(successes, scenes), 1),
                           percent(iou_sum / static_cast<double>(scenes), 1));
    }
};

/// Rows of one objective, condition and rate.
struct Group {
    std::string costs;
    std::string condition;
    std::optional<double> rate;
    std::vector<const OptimalityRow*> rows;
};

/// In the order of the objectives, conditions and rates.
std::vector<Group> groups_of(std::span<const OptimalityRow> rows) {
    std::vector<std::string> costs;
    std::map<std::tuple<std::size_t, std::string, std::optional<double>>, Group> groups;
    for (const OptimalityRow& row : rows) {
        auto known = std::ranges::find(costs, row.costs);
        if (known == costs.end()) known = costs.insert(costs.end(), row.costs);
        const auto place = static_cast<std::size_t>(known - costs.begin());
        const AnnotatedScene& scene = *row.scene;
        Group& group = groups[{place, scene.condition, scene.false_positive_rate}];
        group = {row.costs, scene.condition, scene.false_positive_rate, std::move(group.rows)};
        group.rows.push_back(&row);
    }
    std::vector<Group> result;
    for (auto& [key, group] : groups) result.push_back(std::move(group));
    return result;
}

std::vector<std::string> first_cells(const Group& group) {
    return {group.costs, group.condition.empty() ? "-" : group.condition, percent(group.rate, 1)};
}

/// How near CLC's candidates are to the optimum.
std::string candidates_table(std::span<const Group> groups) {
    TextTable table({{"costs", true},
                     {"condition", true},
                     {"fp %"},
                     {"scenes"},
                     {"proven %"},
                     {"feasible candidates %"},
                     {"compared"},
                     {"equal %"},
                     {"median gap %"},
                     {"p95 gap %"},
                     {"success % opt / cand"},
                     {"IoU % opt / cand"}});
    for (const Group& group : groups) {
        std::size_t proven = 0, candidates = 0, feasible = 0, equal = 0, best = 0, other = 0;
        std::vector<double> gaps, optimum_ious, candidate_ious;
        for (const OptimalityRow* row : group.rows) {
            candidates += row->candidates;
            feasible += row->feasible;
            if (row->status == SolveStatus::optimal || row->status == SolveStatus::infeasible) ++proven;
            const auto gap = row->gap();
            if (!gap) continue;
            gaps.push_back(*gap);
            if (row->is_optimal(row->candidate)) ++equal;
            if (is_success(row->optimum->category)) ++best;
            if (is_success(row->candidate->category)) ++other;
            optimum_ious.push_back(row->optimum->iou);
            candidate_ious.push_back(row->candidate->iou);
        }
        const std::size_t compared = gaps.size();
        const auto figure = [](const std::vector<double>& values, auto of) {
            return values.empty() ? std::nullopt : std::optional<double>(of(values));
        };
        const auto p95 = [](const std::vector<double>& values) { return quantile(values, 0.95); };
        const auto middle = [](const std::vector<double>& values) { return median(values); };
        const auto average = [](const std::vector<double>& values) { return mean(values); };
        std::vector<std::string> cells = first_cells(group);
        for (std::string& cell : std::vector<std::string>{
                 std::to_string(group.rows.size()), percent(share(proven, group.rows.size()), 1),
                 percent(share(feasible, candidates), 1), std::to_string(compared),
                 percent(share(equal, compared), 1), percent(figure(gaps, middle), 3),
                 percent(figure(gaps, p95), 3),
                 percent(share(best, compared), 1) + " / " + percent(share(other, compared), 1),
                 percent(figure(optimum_ious, average), 1) + " / " +
                     percent(figure(candidate_ious, average), 1)})
            cells.push_back(std::move(cell));
        table.add(std::move(cells));
    }
    return table.text();
}

/// What all lanes are worth where the optimum is proven.
std::string quality_table(std::span<const Group> groups) {
    std::vector<TextTable::Column> columns{
        {"costs", true}, {"condition", true}, {"fp %"}, {"proven"}, {"optimum"}};
    for (const Rival& rival : kRivals) columns.push_back({rival.name});
    TextTable table(columns);
    for (const Group& group : groups) {
        Quality optimum;
        std::array<Quality, kRivals.size()> rivals;
        for (const OptimalityRow* row : group.rows) {
            if (row->status != SolveStatus::optimal) continue;
            optimum.add(row->optimum);
            for (std::size_t k = 0; k < rivals.size(); ++k) rivals[k].add(row->*kRivals[k].lane);
        }
        std::vector<std::string> cells = first_cells(group);
        cells.push_back(std::to_string(optimum.scenes));
        cells.push_back(optimum.text());
        for (const Quality& rival : rivals) cells.push_back(rival.text());
        table.add(std::move(cells));
    }
    return table.text();
}

/// What a lane is worth by its gap to the optimum, of all conditions and rates.
std::string gap_table(std::span<const Group> groups) {
    struct Range {
        const char* name;
        double most;
    };
    constexpr std::array kRanges{Range{"none", 0.0}, Range{"to 1 %", 0.01}, Range{"to 10 %", 0.1},
                                 Range{"above", std::numeric_limits<double>::infinity()},
                                 Range{"forbidden", std::numeric_limits<double>::quiet_NaN()}};
    TextTable table({{"costs", true}, {"lane", true}, {"gap", true}, {"scenes"}, {"optimum"}, {"lane"}});
    std::vector<std::string> names;
    for (const Group& group : groups) {
        if (names.empty() || names.back() != group.costs) names.push_back(group.costs);
    }
    for (const std::string& costs : names) {
        for (const auto& [name, lane] : kRivals) {
            std::array<Quality, kRanges.size()> of_optimum;
            std::array<Quality, kRanges.size()> of_lane;
            for (const Group& group : groups) {
                if (group.costs != costs) continue;
                for (const OptimalityRow* row : group.rows) {
                    if (row->status != SolveStatus::optimal || !(row->*lane)) continue;
                    const auto gap = row->gap_of(row->*lane);
                    std::size_t place = kRanges.size() - 1;  // the rows forbid the lane
                    if (gap && row->is_optimal(row->*lane)) {
                        place = 0;
                    } else if (gap) {
                        place = 1;
                        while (*gap > kRanges[place].most) ++place;
                    }
                    of_optimum[place].add(row->optimum);
                    of_lane[place].add(row->*lane);
                }
            }
            for (std::size_t place = 0; place < kRanges.size(); ++place) {
                if (of_lane[place].scenes == 0) continue;
                table.add({costs, name, kRanges[place].name, std::to_string(of_lane[place].scenes),
                           of_optimum[place].text(), of_lane[place].text()});
            }
        }
    }
    return table.text();
}

class OptimalityStudy : public Study {
  public:
    OptimalityStudy()
        : Study(
              {"optimality",
               "how far from the optimum of RLD's objective are the lanes of graph searches, and does the "
               "optimum drive better?",
               "Every scene with a ground truth is solved by path-pair on the cone set that the methods get, "
               "under each of the named costs. Of the candidates of the enumerating method those that RLD's "
               "constraints allow are compared by the objective; a beam search over the same costs, the "
               "answer of that method and that of another one are compared with the optimum too. Gap: "
               "(lane - optimum) / max(1, |optimum|). Quality: usable / success / IoU in %, of scenes with "
               "a proven optimum. Nothing is timed."}) {}

    void add_options(CLI::App& command) override {
        command.add_option("--scenes", scenes_, "*.scenes.jsonl")->required();
        command
            .add_option(
                "--params", costs_,
                fmt::format("RLD parameters, separated by commas, each an objective: default for (29), {} "
                            "or a file (JSON)",
                            fmt::join(rld_parameter_set_names(), ", ")))
            ->delimiter(',')
            ->capture_default_str();
        command.add_option("--pairing", pairing_, "overrides the pairing of the parameters")
            ->check(CLI::IsMember({"paper", "near_far"}));
        command.add_option("--method", options_.detector, "a method that enumerates")->capture_default_str();
        command
            .add_option("--beside", options_.beside,
                        "another method, whose lanes are compared with the optimum; '' for none")
            ->capture_default_str();
        command
            .add_option("--beam-width", options_.beam_width,
                        "number of partial lanes that the beam search keeps, under the same costs")
            ->check(whole_number(1, 1'000'000))
            ->capture_default_str();
        add_nearest_option(command, options_.nearest, "the N nearest cones ahead only; all without it");
        add_time_limit_option(command, options_.time_limit_ms);
        add_threads_option(command, options_.threads, "nothing is timed");
    }

    StudyResult run() override {
        options_.costs.clear();
        for (const std::string& name : costs_)
            options_.costs.push_back({name, ParameterSource{name == "default" ? "" : name, pairing_}.load()});
        const std::vector<AnnotatedScene> scenes = read_scenes(scenes_);
        TrackBoundariesByName tracks;
        const std::filesystem::path boundaries = track_boundaries_path(scenes_);
        if (std::filesystem::exists(boundaries)) tracks = read_track_boundaries(boundaries);
        const std::vector<OptimalityRow> rows = optimality_rows(scenes, tracks, options_);
        return study_result(optimality_table(rows), rows,
                            [&](const OptimalityRow& row) { return to_json(row, options_); });
    }

  private:
    std::string scenes_;
    std::vector<std::string> costs_{"default"};
    std::string pairing_;
    OptimalityOptions options_;
};

}  // namespace

std::optional<double> OptimalityRow::gap_of(const std::optional<JudgedLane>& lane) const {
    if (status != SolveStatus::optimal || !lane || !lane->objective) return std::nullopt;
    return relative_gap(*lane->objective, *optimum->objective);
}

bool OptimalityRow::is_optimal(const std::optional<JudgedLane>& lane) const {
    return gap_of(lane) && *lane->objective - *optimum->objective <= kObjectiveTolerance;
}

std::vector<OptimalityRow> optimality_rows(std::span<const AnnotatedScene> scenes,
                                           const TrackBoundariesByName& tracks,
                                           const OptimalityOptions& options) {
    for (const std::string& name : {options.detector, options.beside}) {
        if (!name.empty()) (void)find_method(name);
    }
    const std::size_t costs = options.costs.size();
    const std::vector<std::size_t> starts = lap_starts(scenes);
    std::vector<OptimalityRow> rows(scenes.size() * costs);
    Progress progress("optimality", scenes.size());
    oneapi::tbb::task_arena arena(
        std::min(static_cast<int>(options.threads), oneapi::tbb::info::default_concurrency()));
    arena.execute([&] {
        oneapi::tbb::parallel_for(std::size_t{0}, starts.size() - 1, [&](std::size_t lap) {
            Lap driven(tracks, options);
            for (std::size_t i = starts[lap]; i < starts[lap + 1]; ++i) {
                if (counts(scenes[i])) driven.drive(scenes[i], std::span(rows).subspan(i * costs, costs));
                progress.advance();
            }
        });
    });
    std::erase_if(rows, [](const OptimalityRow& row) { return row.scene == nullptr; });
    return rows;
}

std::string optimality_table(std::span<const OptimalityRow> rows) {
    const std::vector<Group> groups = groups_of(rows);
    return candidates_table(groups) + "\n" + quality_table(groups) + "\n" + gap_table(groups);
}

std::unique_ptr<Study> make_optimality_study() {
    return std::make_unique<OptimalityStudy>();
}

}  // namespace conelane::experiments
