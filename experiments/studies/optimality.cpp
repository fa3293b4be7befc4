#include "experiments/studies/optimality.hpp"

#include "conelane/check.hpp"
#include "conelane/invalid_input.hpp"
#include "conelane/lane_graph_problem.hpp"
#include "conelane/rld_parameter_sets.hpp"
#include "conelane/solve_scene.hpp"
#include "evaluation/proofs/answer_check.hpp"
#include "experiments/methods/method.hpp"
#include "experiments/options/shared_options.hpp"
#include "experiments/options/whole_number.hpp"
#include "experiments/progress/progress.hpp"
#include "experiments/studies/lane_graph_beam.hpp"
#include "experiments/studies/solve_study.hpp"
#include "experiments/studies/study.hpp"
#include "solvers/registry.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
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

/// A lane of a row for a file.
FieldValue lane_value(const OptimalityRow& row, const std::optional<JudgedLane>& lane, bool with_gap) {
    if (!lane) return std::nullopt;
    const RowFields<JudgedLane> fields{
        {"category", [](const JudgedLane& one) { return to_string(one.category); }},
        {"iou", &JudgedLane::iou},
        {"usable", &JudgedLane::usable},
        {"objective", &JudgedLane::objective},
        {"gap", [&](const JudgedLane&) { return with_gap ? row.gap_of(lane) : std::nullopt; }}};
    return row_json(*lane, fields);
}

RowFields<OptimalityRow> fields_of_file(const OptimalityOptions& options) {
    using Row = OptimalityRow;
    RowFields<Row> fields = with_scene<Row>(
        {{"false_positive_rate", [](const Row& row) { return row.scene->false_positive_rate; }},
         {"range", [](const Row& row) { return row.scene->range_m; }},
         {"condition",
          [](const Row& row) {
              return row.scene->condition.empty() ? FieldValue() : row.scene->condition;
          }},
         {"costs", &Row::costs},
         {"method", [&](const Row&) { return options.detector; }},
         {"method_beside", [&](const Row&) { return options.beside.empty() ? FieldValue() : options.beside; }},
         {"beam_width", [&](const Row&) { return options.beam_width; }},
         {"nearest", [&](const Row&) { return options.nearest; }},
         {"status", &Row::status},
         {"bound", [](const Row& row) { return bound_value(row.bound); }},
         {"candidates", &Row::candidates},
         {"feasible_candidates", &Row::feasible},
         {"optimum", [](const Row& row) { return lane_value(row, row.optimum, false); }}});
    for (const auto& [name, lane] : kRivals)
        fields.push_back({name, [lane = lane](const Row& row) { return lane_value(row, row.*lane, true); }});
    fields.push_back({"gap", &Row::gap});
    fields.push_back({"equal", [](const Row& row) {
                          return row.gap() ? std::optional(row.is_optimal(row.candidate)) : std::nullopt;
                      }});
    return fields;
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

using Group = RowGroup<OptimalityRow>;

/// In the order of the objectives, conditions and rates.
std::vector<Group> groups_of_rows(std::span<const OptimalityRow> rows) {
    std::vector<Group> groups;
    const auto condition_and_rate = [](const OptimalityRow& row) {
        return std::pair(row.scene->condition, row.scene->false_positive_rate);
    };
    for (const Group& of_costs : groups_of<OptimalityRow>(rows, std::mem_fn(&OptimalityRow::costs))) {
        std::vector<Group> some = groups_of<OptimalityRow>(of_costs.each(), condition_and_rate);
        std::ranges::sort(some, {}, [&](const Group& group) { return condition_and_rate(group.first()); });
        groups.insert(groups.end(), some.begin(), some.end());
    }
    return groups;
}

/// The columns of a group, then others.
RowFields<Group> with_group(const RowFields<Group>& others) {
    using Row = OptimalityRow;
    RowFields<Group> fields{
        {"", first_of(&Row::costs), Shown::text("costs")},
        {"",
         first_of([](const Row& row) { return row.scene->condition.empty() ? "-" : row.scene->condition; }),
         Shown::text("condition")},
        {"", first_of([](const Row& row) { return row.scene->false_positive_rate; }), Shown::percent("fp %", 1)}};
    fields.insert(fields.end(), others.begin(), others.end());
    return fields;
}

/// How near CLC's candidates are to the optimum.
std::string candidates_table(std::span<const Group> groups) {
    using Row = OptimalityRow;
    const auto of_compared = [](auto get) {
        return [get](const Row& row) { return row.gap() ? std::optional(get(row)) : std::nullopt; };
    };
    const auto iou = [&](std::optional<JudgedLane> Row::*lane) {
        return of_compared([lane](const Row& row) { return (row.*lane)->iou; });
    };
    const auto success = [&](std::optional<JudgedLane> Row::*lane) {
        return of_compared([lane](const Row& row) { return is_success((row.*lane)->category) ? 1.0 : 0.0; });
    };
    const auto both = [](auto best, auto other) {
        return [=](const Group& group) {
            return percent(group.sample(best).mean(), 1) + " / " + percent(group.sample(other).mean(), 1);
        };
    };
    const auto feasible_share = [](const Group& group) {
        std::size_t feasible = 0, candidates = 0;
        for (const Row* row : group.rows) feasible += row->feasible, candidates += row->candidates;
        return share(feasible, candidates);
    };
    const auto equal = of_compared([](const Row& row) { return row.is_optimal(row.candidate) ? 1.0 : 0.0; });
    const auto is_proven = [](const Row& row) {
        return row.status == SolveStatus::optimal || row.status == SolveStatus::infeasible;
    };
    return row_table(
        groups,
        with_group({{"", &Group::size, Shown::number("scenes")},
                    {"", share_of(is_proven), Shown::percent("proven %", 1)},
                    {"", feasible_share, Shown::percent("feasible candidates %", 1)},
                    {"", count_of(&Row::gap), Shown::number("compared")},
                    {"", mean_of(equal), Shown::percent("equal %", 1)},
                    {"", median_of(&Row::gap), Shown::percent("median gap %", 3)},
                    {"", quantile_of(&Row::gap, 0.95), Shown::percent("p95 gap %", 3)},
                    {"", both(success(&Row::optimum), success(&Row::candidate)),
                     Shown::number("success % opt / cand")},
                    {"", both(iou(&Row::optimum), iou(&Row::candidate)), Shown::number("IoU % opt / cand")}}));
}

/// What all lanes are worth where the optimum is proven.
std::string quality_table(std::span<const Group> groups) {
    using Row = OptimalityRow;
    const auto is_optimal = [](const Row& row) { return row.status == SolveStatus::optimal; };
    const auto quality = [&](std::optional<JudgedLane> Row::*lane) {
        return [=](const Group& group) {
            Quality of_proven;
            for (const Row* row : group.rows) {
                if (is_optimal(*row)) of_proven.add(row->*lane);
            }
            return of_proven.text();
        };
    };
    RowFields<Group> fields = with_group({{"", count_of(is_optimal), Shown::number("proven")},
                                          {"", quality(&Row::optimum), Shown::number("optimum")}});
    for (const auto& [name, lane] : kRivals) fields.push_back({"", quality(lane), Shown::number(name)});
    return row_table(groups, fields);
}

/// A range of gaps to the optimum.
struct GapRange {
    const char* name;
    double most;
};
constexpr std::array kRanges{GapRange{"none", 0.0}, GapRange{"to 1 %", 0.01}, GapRange{"to 10 %", 0.1},
                             GapRange{"above", std::numeric_limits<double>::infinity()},
                             GapRange{"forbidden", std::numeric_limits<double>::quiet_NaN()}};

/// A lane whose scene has a proven optimum.
struct Rivalry {
    const OptimalityRow* row;
    const Rival* rival;
    const GapRange* range;

    Rivalry(const OptimalityRow& of, const Rival& by) : row(&of), rival(&by), range(&kRanges.back()) {
        const auto gap = of.gap_of(lane());
        if (!gap) return;  // the rows forbid the lane
        range = of.is_optimal(lane()) ? &kRanges.front() : &kRanges[1];
        while (!of.is_optimal(lane()) && *gap > range->most) ++range;
    }
    [[nodiscard]] const std::optional<JudgedLane>& lane() const { return row->*(rival->lane); }
};

/// What a lane is worth by its gap to the optimum, of all conditions and rates.
std::string gap_table(std::span<const OptimalityRow> rows) {
    std::vector<Rivalry> all;
    for (const Group& of_costs : groups_of<OptimalityRow>(rows, std::mem_fn(&OptimalityRow::costs))) {
        for (const Rival& rival : kRivals) {
            const auto first = static_cast<std::ptrdiff_t>(all.size());
            for (const OptimalityRow* row : of_costs.rows) {
                if (row->status == SolveStatus::optimal && row->*rival.lane) all.emplace_back(*row, rival);
            }
            std::ranges::stable_sort(all.begin() + first, all.end(), {}, &Rivalry::range);
        }
    }
    const auto quality = [](auto lane_of) {
        return [lane_of](const RowGroup<Rivalry>& group) {
            Quality quality;
            for (const Rivalry* one : group.rows) quality.add(lane_of(*one));
            return quality.text();
        };
    };
    const RowFields<RowGroup<Rivalry>> fields{
        {"", first_of([](const Rivalry& one) { return one.row->costs; }), Shown::text("costs")},
        {"", first_of([](const Rivalry& one) { return one.rival->name; }), Shown::text("lane")},
        {"", first_of([](const Rivalry& one) { return one.range->name; }), Shown::text("gap")},
        {"", &RowGroup<Rivalry>::size, Shown::number("scenes")},
        {"", quality([](const Rivalry& one) { return one.row->optimum; }), Shown::number("optimum")},
        {"", quality([](const Rivalry& one) { return one.lane(); }), Shown::number("lane")}};
    return row_table(groups_of<Rivalry>(all,
                                        [](const Rivalry& one) {
                                            return std::tuple(one.row->costs, one.rival, one.range);
                                        }),
                     fields);
}

class OptimalityStudy : public SceneStudy {
  public:
    OptimalityStudy()
        : SceneStudy(
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
        SceneStudy::add_options(command);
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

    StudyResult measure(const SceneSet& set) override {
        options_.costs.clear();
        for (const std::string& name : costs_)
            options_.costs.push_back({name, ParameterSource{name == "default" ? "" : name, pairing_}.load()});
        const std::vector<OptimalityRow> rows = optimality_rows(set, options_);
        StudyResult result{optimality_table(rows)};
        result.add_rows(rows, fields_of_file(options_));
        return result;
    }

  private:
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

std::vector<OptimalityRow> optimality_rows(const SceneSet& set, const OptimalityOptions& options) {
    const std::vector<AnnotatedScene>& scenes = set.scenes;
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
            Lap driven(set.tracks, options);
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
    const std::vector<Group> groups = groups_of_rows(rows);
    return candidates_table(groups) + "\n" + quality_table(groups) + "\n" + gap_table(rows);
}

std::unique_ptr<Study> make_optimality_study() {
    return std::make_unique<OptimalityStudy>();
}

}  // namespace conelane::experiments
