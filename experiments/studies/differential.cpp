#include "experiments/studies/differential.hpp"

#include "conelane/check.hpp"
#include "conelane/invalid_input.hpp"
#include "conelane/solve_scene.hpp"
#include "evaluation/files/json_node.hpp"
#include "evaluation/scenes/scene_file.hpp"
#include "evaluation/seeded_random.hpp"
#include "experiments/options/whole_number.hpp"
#include "experiments/progress/progress.hpp"
#include "experiments/studies/cone_sets.hpp"
#include "experiments/studies/study.hpp"
#include "experiments/studies/study_options.hpp"
#include "solvers/registry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <boost/random/bernoulli_distribution.hpp>
#include <fmt/format.h>

namespace conelane::experiments {
namespace {

constexpr std::size_t kMinConesDrawn = 12;
constexpr std::size_t kMaxConesDrawn = 40;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The proven interval: the optimum is in [lower, upper].
struct Range {
    double lower = -kInfinity;
    double upper = kInfinity;
};

Range range_of(const RldReport& report) {
    if (report.status == SolveStatus::infeasible) return {kInfinity, kInfinity};
    return {report.bound.value_or(-kInfinity), report.objective.value_or(kInfinity)};
}

bool is_proof(const RldReport& report) {
    return report.status == SolveStatus::optimal || report.status == SolveStatus::infeasible;
}

RldParameters parameters_of(const DifferentialCase& drawn) {
    RldParameters parameters = drawn.shape_costs ? with_shape_costs({}) : RldParameters{};
    parameters.pairing = drawn.pairing;
    return parameters;
}

/// The objection of the checker or the solver to the answer; empty if there is none.
std::string objection(const RldReport& report, const Scene& cones, const RldParameters& parameters) {
    if (report.status == SolveStatus::error) return report.message;
    if (!report.lane_graph) return {};
    const Claim claim{report.status == SolveStatus::optimal, *report.objective, report.bound};
    const CheckReport checked = check(cones, parameters, *report.lane_graph, claim);
    return checked.violations.empty() ? std::string{} : checked.violations.front();
}

DifferentialRow solve_both(const DifferentialCase& drawn, RldSolver& path_pair, RldSolver& reference,
                           double time_limit_ms) {
    const Scene cones = nearest_ahead(drawn.scene->scene, drawn.cones);
    const RldParameters parameters = parameters_of(drawn);
    DifferentialRow row{drawn, Agreement::refused, {}, {}, {}};
    row.path_pair = solve_scene(path_pair, cones, parameters, {time_limit_ms}).report;
    row.reference = solve_scene(reference, cones, parameters, {time_limit_ms}).report;
    for (const RldReport* report : {&row.path_pair, &row.reference}) {
        if (row.message.empty()) row.message = objection(*report, cones, parameters);
    }
    if (row.message.empty()) row.agreement = compare_reports(row.path_pair, row.reference);
    return row;
}

nlohmann::ordered_json to_json(const RldReport& report) {
    nlohmann::ordered_json json{{"status", to_string(report.status)}};
    if (report.objective) json["objective"] = *report.objective;
    if (report.bound) put_bound(json, *report.bound, "bound");
    json["nodes"] = report.nodes;
    return json;
}

nlohmann::ordered_json row_to_json(const DifferentialRow& row) {
    nlohmann::ordered_json json{{"case", row.drawn.number},
                                {"scene", row.drawn.scene->scene.id},
                                {"nearest", row.drawn.cones},
                                {"pairing", to_string(row.drawn.pairing)},
                                {"shape_costs", row.drawn.shape_costs},
                                {"agreement", to_string(row.agreement)}};
    if (!row.message.empty()) json["message"] = row.message;
    json["path_pair"] = to_json(row.path_pair);
    json["reference"] = to_json(row.reference);
    return json;
}

class DifferentialStudy : public Study {
  public:
    DifferentialStudy()
        : Study(
              {"differential", "do path-pair and another exact solver ever contradict each other?",
               "Case k of a seed draws a scene, its 12 to 40 nearest cones, the pairing and the costs. Both "
               "solve it; every lane graph passes the independent checker. They differ if the proven bound "
               "of one is above the objective of the other by more than 1e-6."}) {}

    void add_options(CLI::App& command) override {
        command.add_option("--scenes", scenes_, "*.scenes.jsonl")->required();
        command.add_option("--seed", options_.seed, "seed of the cases")->capture_default_str();
        command.add_option("--first", options_.first, "number of the first case, to cut a run into parts")
            ->capture_default_str();
        command.add_option("--cases", options_.cases, "number of cases")
            ->check(whole_number(1, 10'000'000))
            ->capture_default_str();
        command.add_option("--reference", options_.reference, "the other solver, an exact one of any size")
            ->capture_default_str();
        add_time_limit_option(command, options_.time_limit_ms);
    }

    StudyResult run() override {
        const std::vector<AnnotatedScene> scenes = read_scenes(scenes_);
        const std::vector<DifferentialRow> rows = differential_rows(scenes, options_);
        return study_result(differential_outcome(rows, options_), rows,
                            [](const DifferentialRow& row) { return row_to_json(row); });
    }

  private:
    std::string scenes_;
    DifferentialOptions options_;
};

}  // namespace

std::string_view to_string(Agreement agreement) {
    switch (agreement) {
        case Agreement::same_optimum:
            return "same optimum";
        case Agreement::both_infeasible:
            return "both infeasible";
        case Agreement::undecided:
            return "undecided";
        case Agreement::refused:
            return "refused";
        case Agreement::differ:
            return "differ";
    }
    return "";
}

DifferentialCase draw_case(std::span<const AnnotatedScene> scenes, std::uint64_t seed, std::size_t number) {
    using Size = boost::random::uniform_int_distribution<std::size_t>;
    boost::random::mt19937_64 random = generator_of(fmt::format("case {}", number), seed);
    DifferentialCase drawn;
    drawn.number = number;
    drawn.scene = &scenes[Size(0, scenes.size() - 1)(random)];
    drawn.cones = Size(kMinConesDrawn, kMaxConesDrawn)(random);
    const boost::random::bernoulli_distribution<> coin(0.5);
    drawn.pairing = coin(random) ? Pairing::paper : Pairing::near_far;
    drawn.shape_costs = coin(random);
    return drawn;
}

Agreement compare_reports(const RldReport& first, const RldReport& second) {
    const Range one = range_of(first);
    const Range other = range_of(second);
    const auto above = [](double lower, double upper) {
        return std::isfinite(upper) && lower > upper + kObjectiveTolerance;
    };
    if (above(one.lower, other.upper) || above(other.lower, one.upper)) return Agreement::differ;
    if (!is_proof(first) || !is_proof(second)) return Agreement::undecided;
    return first.status == SolveStatus::infeasible ? Agreement::both_infeasible : Agreement::same_optimum;
}

std::vector<DifferentialRow> differential_rows(std::span<const AnnotatedScene> scenes,
                                               const DifferentialOptions& options) {
    if (scenes.empty()) throw InvalidInput("--scenes", "hold no scene");
    const RldSolverEntry* const entry = find_rld_solver(options.reference);
    if (entry == nullptr || !entry->exact || entry->max_cones)
        throw InvalidInput("--reference", "'" + options.reference + "' is not an exact solver for all sizes");
    const std::unique_ptr<RldSolver> path_pair = find_rld_solver("path-pair")->make(Formulation::tight);
    const std::unique_ptr<RldSolver> reference = entry->make(Formulation::tight);
    std::vector<DifferentialRow> rows;
    rows.reserve(options.cases);
    Progress progress("differential", options.cases);
    for (std::size_t k = 0; k < options.cases; ++k) {
        const DifferentialCase drawn = draw_case(scenes, options.seed, options.first + k);
        rows.push_back(solve_both(drawn, *path_pair, *reference, options.time_limit_ms));
        progress.advance();
    }
    return rows;
}

std::string differential_outcome(std::span<const DifferentialRow> rows, const DifferentialOptions& options) {
    const auto count = [&](Agreement agreement) {
        return std::ranges::count(rows, agreement, &DifferentialRow::agreement);
    };
    const auto unproven = [&](RldReport DifferentialRow::*report) {
        return std::ranges::count_if(rows, [&](const DifferentialRow& row) {
            return row.agreement == Agreement::undecided && !is_proof(row.*report);
        });
    };
    return fmt::format(
        "{} cases of seed {} from {} on: {} the same optimum, {} both infeasible, {} undecided (path-pair "
        "{}, "
        "{} {}), {} refused, {} differ\n",
        rows.size(), options.seed, options.first, count(Agreement::same_optimum),
        count(Agreement::both_infeasible), count(Agreement::undecided), unproven(&DifferentialRow::path_pair),
        options.reference, unproven(&DifferentialRow::reference), count(Agreement::refused),
        count(Agreement::differ));
}

std::unique_ptr<Study> make_differential_study() {
    return std::make_unique<DifferentialStudy>();
}

}  // namespace conelane::experiments
