#include "conelane/rld_parameter_sets.hpp"
#include "detectors/parameters/learned_costs_reader.hpp"
#include "detectors/recipe.hpp"
#include "evaluation/progress/progress.hpp"
#include "evaluation/proofs/answer_check.hpp"
#include "evaluation/scoring/score.hpp"
#include "experiments/methods/method.hpp"
#include "experiments/studies/scene_objective.hpp"
#include "experiments/studies/solve_rows.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

namespace conelane::experiments {
namespace {

struct OptimalityOptions {
    std::string detector = "clc";        ///< one that enumerates
    std::string beside = "front";        ///< one whose lanes are compared with the optimum; none if empty
    std::optional<std::size_t> nearest;  ///< cone set of all; all cones if absent
    std::vector<NamedCosts> costs{{}};   ///< at least one
    std::size_t beam_width = 100;        ///< see beams.hpp
    double time_limit_ms = 400.0;        ///< of the exact search, a scene
    unsigned threads = 1;
};

/// A lane under an objective and against the ground truth.
struct JudgedLane {
    std::optional<double> objective;  ///< absent if the constraints forbid the lane
    Category category = Category::none;
    double iou = 0.0;
    std::optional<bool> usable;  ///< absent where no boundaries are known
};

/// One scene under one objective. Candidates are distinct as sets of edges.
struct OptimalityRow {
    const AnnotatedScene* scene = nullptr;
    std::string costs;                        ///< the name of the objective
    SolveStatus status = SolveStatus::error;  ///< of the exact search
    std::optional<double> bound;
    std::size_t candidates = 0;
    std::size_t feasible = 0;             ///< of them, under the constraints
    std::optional<JudgedLane> optimum;    ///< the best lane that the exact search found
    std::optional<JudgedLane> beam;       ///< of the beam search under the same objective
    std::optional<JudgedLane> candidate;  ///< the feasible one of least objective; of equal ones the first
    std::optional<JudgedLane> choice;     ///< what the method answers
    std::optional<JudgedLane> beside;     ///< what the method beside it answers

    /// (lane - optimum) / max(1, |optimum|), at least 0; where the optimum is proven and the lane has an
    /// objective.
    [[nodiscard]] std::optional<double> gap_of(const std::optional<JudgedLane>& lane) const {
        if (!is_proven() || !lane || !lane->objective) return std::nullopt;
        return relative_gap(*lane->objective, *optimum->objective);
    }
    /// That of the candidate.
    [[nodiscard]] std::optional<double> gap() const { return gap_of(candidate); }
    /// Whether the candidate's gap is within the solvers' tolerance; absent without a gap.
    [[nodiscard]] std::optional<bool> is_equal() const {
        if (!gap()) return std::nullopt;
        return *candidate->objective - *optimum->objective <= kObjectiveTolerance;
    }
    /// Whether the optimum is known.
    [[nodiscard]] bool is_proven() const { return status == SolveStatus::optimal; }
};

std::unique_ptr<LaneDetector> made(const std::string& name, const OptimalityOptions& options) {
    const DetectorRecipe& recipe = *find_method(name).recipe;
    return make_detector(recipe, options_used_by(recipe, {{}, {}, options.nearest}));
}

constexpr DetectionLimits kWholeSearch{std::numeric_limits<double>::infinity(), true};

/// One lap with the state that detectors carry along it.
class Lap {
  public:
    Lap(const TrackBoundariesByName& tracks, const OptimalityOptions& options)
        : tracks_(tracks), options_(options), detector_(made(options.detector, options)) {
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
            OptimalityRow& row = rows[k];
            row.scene = &annotated;
            row.costs = options_.costs[k].name;
            const std::unique_ptr<SceneObjective> objective = objective_of(cones, options_.costs[k]);
            const ProvenLane optimum = objective->optimum(options_.time_limit_ms);
            row.status = optimum.status;
            row.bound = optimum.bound;
            if (optimum.lane) row.optimum = judged(optimum.lane->lane, annotated, optimum.lane->cost);
            const auto with_cost = [&](const LaneAnswer& of) -> std::optional<JudgedLane> {
                if (of.status != LaneStatus::found) return std::nullopt;
                return judged(of.lane, annotated, objective->cost(of.lane));
            };
            row.choice = with_cost(answer);
            if (beside) row.beside = with_cost(*beside);
            compare_candidates(row, answer.enumeration->candidates, *objective, cones);
            if (const auto lane = objective->beam(options_.beam_width))
                row.beam = found_by_search(row, {*lane, objective->cost(*lane).value()}, *objective,
                                           "lane of the beam");
        }
    }

  private:
    void compare_candidates(OptimalityRow& row, const std::vector<LaneCandidate>& candidates,
                            const SceneObjective& objective, const Scene& cones) const {
        std::set<std::vector<Edge>> met;
        std::optional<PricedLane> best;
        for (const LaneCandidate& candidate : candidates) {
            const auto graph = lane_graph_of(candidate.lane, cones);
            if (!graph || !met.insert(graph->edges).second) continue;
            ++row.candidates;
            const std::optional<double> cost = objective.cost(candidate.lane);
            if (!cost) continue;
            ++row.feasible;
            if (!best || *cost < best->cost) best = {candidate.lane, *cost};
        }
        if (best) row.candidate = found_by_search(row, *best, objective, "candidate");
    }

    /// Throws where it contradicts the checker or what was proven.
    [[nodiscard]] JudgedLane found_by_search(const OptimalityRow& row, const PricedLane& lane,
                                             const SceneObjective& objective, const char* what) const {
        objective.check(lane, what);
        const std::string& scene = row.scene->scene.id;
        if (row.status == SolveStatus::infeasible) {
            throw InvalidInput(
                scene, fmt::format("a {} is feasible, but the exact search proved that there is none", what));
        }
        if (row.is_proven() && lane.cost < *row.optimum->objective - kObjectiveTolerance) {
            throw InvalidInput(scene, fmt::format("a {} has the objective {}, below the proven optimum {}",
                                                  what, lane.cost, *row.optimum->objective));
        }
        return judged(lane.lane, *row.scene, lane.cost);
    }

    [[nodiscard]] JudgedLane judged(const Lane& lane, const AnnotatedScene& annotated,
                                    std::optional<double> cost) const {
        const auto track = tracks_.find(annotated.track);
        LaneAnswer answer;
        answer.status = LaneStatus::found;
        answer.lane = lane;
        const SceneScore result = score(annotated, answer, 0.0, options_.nearest,
                                        track == tracks_.end() ? nullptr : &track->second);
        return {cost, result.category, result.iou.value_or(0.0), result.usable()};
    }

    const TrackBoundariesByName& tracks_;
    const OptimalityOptions& options_;
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
          [](const Row& row) { return row.scene->condition.empty() ? FieldValue() : row.scene->condition; }},
         {"costs", &Row::costs},
         {"method", [&](const Row&) { return options.detector; }},
         {"method_beside",
          [&](const Row&) { return options.beside.empty() ? FieldValue() : options.beside; }},
         {"beam_width", [&](const Row&) { return options.beam_width; }},
         {"nearest", [&](const Row&) { return options.nearest; }},
         {"status", &Row::status},
         {"bound", [](const Row& row) { return bound_value(row.bound); }},
         {"candidates", &Row::candidates},
         {"feasible_candidates", &Row::feasible},
         {"optimum", [](const Row& row) { return lane_value(row, row.optimum, false); }}});
    for (const auto& [name, lane] : kRivals)
        fields.emplace_back(name, [lane = lane](const Row& row) { return lane_value(row, row.*lane, true); });
    fields.emplace_back("gap", &Row::gap);
    fields.emplace_back("equal", &Row::is_equal);
    return fields;
}

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
    RowFields<Group> fields{{"", first_of(&Row::costs), Shown::text("costs")},
                            {"", first_of([](const Row& row) {
                                 return row.scene->condition.empty() ? "-" : row.scene->condition;
                             }),
                             Shown::text("condition")},
                            {"", first_of([](const Row& row) { return row.scene->false_positive_rate; }),
                             Shown::percent("fp %", 1)}};
    fields.insert(fields.end(), others.begin(), others.end());
    return fields;
}

/// How near CLC's candidates are to the optimum.
std::string candidates_table(std::span<const Group> groups) {
    using Row = OptimalityRow;
    /// The optimum and the candidate where both are compared.
    const auto both = [](auto get) {
        return [get](const Group& group) {
            const auto of = [&](std::optional<JudgedLane> Row::*lane) {
                return percent(group
                                   .sample([&](const Row& row) -> std::optional<double> {
                                       if (!row.gap()) return std::nullopt;
                                       return get(*(row.*lane));
                                   })
                                   .mean(),
                               1);
            };
            return of(&Row::optimum) + " / " + of(&Row::candidate);
        };
    };
    const auto feasible_share = [](const Group& group) {
        std::size_t feasible = 0, candidates = 0;
        for (const Row* row : group.rows) feasible += row->feasible, candidates += row->candidates;
        return share(feasible, candidates);
    };
    const auto is_decided = [](const Row& row) {
        return row.is_proven() || row.status == SolveStatus::infeasible;
    };
    const auto success = both([](const JudgedLane& lane) { return is_success(lane.category); });
    const auto iou = both([](const JudgedLane& lane) { return lane.iou; });
    return row_table(groups, with_group({{"", &Group::size, Shown::number("scenes")},
                                         {"", share_of(is_decided), Shown::percent("proven %", 1)},
                                         {"", feasible_share, Shown::percent("feasible candidates %", 1)},
                                         {"", count_of(&Row::gap), Shown::number("compared")},
                                         {"", mean_of(&Row::is_equal), Shown::percent("equal %", 1)},
                                         {"", median_of(&Row::gap), Shown::percent("median gap %", 3)},
                                         {"", quantile_of(&Row::gap, 0.95), Shown::percent("p95 gap %", 3)},
                                         {"", success, Shown::number("success % opt / cand")},
                                         {"", iou, Shown::number("IoU % opt / cand")}}));
}

/// What all lanes are worth where the optimum is proven: usable / success / IoU in percent. No lane is
/// neither usable nor a success.
std::string quality_table(std::span<const Group> groups) {
    using Row = OptimalityRow;
    const auto quality = [](std::optional<JudgedLane> Row::*lane) {
        return [lane](const Group& group) {
            const auto mean = [&](auto get) {
                return percent(group
                                   .sample([&](const Row& row) -> std::optional<double> {
                                       if (!row.is_proven()) return std::nullopt;
                                       return row.*lane ? get(*(row.*lane)) : 0.0;
                                   })
                                   .mean(),
                               1);
            };
            using Figure = std::optional<double>;
            return fmt::format("{} / {} / {}",
                               mean([](const JudgedLane& one) -> Figure { return one.usable; }),
                               mean([](const JudgedLane& one) -> Figure { return is_success(one.category); }),
                               mean([](const JudgedLane& one) -> Figure { return one.iou; }));
        };
    };
    RowFields<Group> fields = with_group({{"", count_of(&Row::is_proven), Shown::number("proven")},
                                          {"", quality(&Row::optimum), Shown::number("optimum")}});
    for (const auto& [name, lane] : kRivals) fields.emplace_back("", quality(lane), Shown::number(name));
    return row_table(groups, fields);
}

/// Each scene that counts (see `counts`) under each objective, in the order of the scenes, then of the
/// objectives; the same with any number of threads. Throws InvalidInput where there is no such detector or
/// the one that has to enumerate does not, and naming the scene where a lane has a lower objective than an
/// optimum said to be proven or the independent checker rejects a lane graph.
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

StripParameters strip_parameters(const std::string& weights) {
    StripParameters parameters = driving_strip_parameters();
    parameters.costs =
        weights == "shipped" ? parse_strip_costs(kStripWeightsFile) : read_strip_costs(weights);
    return parameters;
}

class OptimalityStudy : public SceneStudy {
  public:
    OptimalityStudy()
        : SceneStudy(
              {"optimality",
               "how far from the optimum of RLD's objective are the lanes of graph searches, and does the "
               "optimum drive better?",
               "Every scene with a ground truth is solved by path-pair on the cone set that the methods get, "
               "under each of the named costs, and by the exact search of strips under those of the strip. "
               "Of "
               "the candidates of the enumerating method those that the constraints allow are compared by "
               "the objective; a beam search over the same costs, the "
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
        command.add_option("--strip", strip_,
                           "also the strip program, as objective `strip`: `shipped`, or a file of learned "
                           "costs (JSON)");
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
        if (!strip_.empty()) options_.costs.push_back({"strip", strip_parameters(strip_)});
        const std::vector<OptimalityRow> rows = optimality_rows(set, options_);
        const std::vector<Group> groups = groups_of_rows(rows);
        StudyResult result{candidates_table(groups) + "\n" + quality_table(groups)};
        result.add_rows(rows, fields_of_file(options_));
        return result;
    }

  private:
    std::vector<std::string> costs_{"default"};
    std::string pairing_;
    std::string strip_;
    OptimalityOptions options_;
};

}  // namespace

std::unique_ptr<Study> make_optimality_study() {
    return std::make_unique<OptimalityStudy>();
}

}  // namespace conelane::experiments
