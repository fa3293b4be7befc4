#include "conelane/check.hpp"
#include "evaluation/formats/solution_file.hpp"
#include "evaluation/input_error.hpp"
#include "evaluation/progress/progress.hpp"
#include "evaluation/proofs/answer_check.hpp"
#include "evaluation/proofs/exact_program.hpp"
#include "evaluation/world/ground_truth.hpp"
#include "program/commands/command_parts.hpp"
#include "program/commands/commands.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>
#include <variant>

#include <fmt/ranges.h>

namespace conelane::program {
namespace {

struct CheckOptions {
    std::string scenes;
    std::string solutions;
    ParameterSource parameters;
    std::optional<std::size_t> nearest;
    double time_limit_ms = 10'000.0;
    bool partial = false;
    bool exact = false;
};

/// A lane graph that the checker accepts, and its source.
struct KnownLaneGraph {
    std::string origin;
    double objective;
};

/// A scene as a solver got it, and what is known about it.
struct ConeSet {
    Scene scene;
    std::optional<KnownLaneGraph> best;

    void learn(const KnownLaneGraph& known) {
        if (!best || known.objective < best->objective) best = known;
    }
};

/// Results of rational arithmetic for all records together.
struct ExactTotals {
    std::size_t programs = 0;
    std::size_t too_large = 0;
    std::size_t rows = 0;
    double objective_difference = 0.0;  ///< of a stated objective
    double objective_rounding = 0.0;    ///< of the program's objective, summed in double
    double row_rounding = 0.0;          ///< of a row's sum in double
    double violation = 0.0;             ///< of a row or of a column's bounds
};

/// The record's edges, or what is wrong with them.
std::variant<LaneGraph, std::string> lane_graph_of(const SolutionRecord& record, const Scene& scene) {
    const auto index_of = index_by_id(scene);
    LaneGraph graph;
    for (const auto& [a, b] : record.edges) {
        for (const ConeId id : {a, b}) {
            if (!index_of.contains(id)) return fmt::format("cone {} is not in the scene", id);
        }
        graph.edges.push_back(make_edge(index_of.at(a), index_of.at(b)));
    }
    std::ranges::sort(graph.edges);
    return graph;
}

bool has_lane_graph(const SolutionRecord& record) {
    return record.status == "optimal" || record.status == "feasible";
}
bool claims_nothing(const SolutionRecord& record) {
    return !has_lane_graph(record) && record.status != "infeasible";
}

class Check {
  public:
    explicit Check(const CheckOptions& options)
        : options_(options),
          parameters_(options.parameters.load()),
          scenes_(options.scenes),
          records_(read_solutions(options.solutions)) {
        if (records_.empty()) throw InputError(options.solutions, 0, "", "holds no solution");
        const ClaimBasis checked{tag_of(options.parameters.name, parameters_), options.nearest};
        for (const SolutionRecord& record : records_) {
            (void)scenes_.of(record.scene, options.solutions, record.line);
            require_same_basis({record.parameters, record.nearest}, checked, options.solutions, record.line);
        }
    }

    /// Prints the problems; returns whether every claim is proven and every scene has an answer.
    bool run() {
        std::vector<std::vector<std::string>> violations;
        violations.reserve(records_.size());
        for (const SolutionRecord& record : records_) violations.push_back(check_lane_graph(record));
        // Claims of proof are checked last, because any lane graph of the file may refute them.
        Progress progress("check", records_.size());
        std::size_t silent = 0;
        std::size_t passed = 0;
        std::size_t failed = 0;
        for (std::size_t i = 0; i < records_.size(); ++i) {
            const SolutionRecord& record = records_[i];
            bool is_unverified = false;
            if (violations[i].empty()) {
                if (auto fault = check_proof(record, is_unverified))
                    violations[i].push_back(std::move(*fault));
            }
            for (const std::string& fault : violations[i]) fmt::print("{}: {}\n", record.scene, fault);
            if (is_unverified) {
                ++unverified_;
            } else if (!violations[i].empty()) {
                ++failed;
            } else {
                ++(claims_nothing(record) ? silent : passed);
            }
            progress.advance();
        }
        failed += count_missing();
        if (options_.exact) print_exact();
        if (silent > 0) fmt::print("{} claim nothing (stopped or error) and are not counted\n", silent);
        if (proven_ > 0) fmt::print("{} claimed optima and infeasibilities are proven\n", proven_);
        if (unverified_ > 0) fmt::print("{} unverified\n", unverified_);
        fmt::print("{} passed, {} failed\n", passed, failed);
        return failed + unverified_ == 0;
    }

  private:
    /// The cones that the record is about, according to the option or to the record.
    ConeSet& cone_set(const SolutionRecord& record) {
        const std::optional<std::size_t> nearest = options_.nearest ? options_.nearest : record.nearest;
        const auto [place, is_new] = cone_sets_.try_emplace({record.scene, nearest});
        ConeSet& set = place->second;
        if (!is_new) return set;
        const AnnotatedScene& annotated = scenes_.of(record.scene, options_.solutions, record.line);
        set.scene = cones_asked_for(annotated.scene, nearest);
        if (!annotated.ground_truth) return set;
        Lane lane = *annotated.ground_truth;
        if (nearest) lane = cut_to_nearest(std::move(lane), annotated.scene, *nearest);
        const auto graph = conelane::lane_graph_of(lane, set.scene);
        if (!graph) return set;
        const CheckReport report = check(set.scene, parameters_, *graph);
        if (report.violations.empty()) set.learn({"the ground truth", report.objective.value()});
        return set;
    }

    /// What is wrong with the record's lane graph and with its statements about it.
    std::vector<std::string> check_lane_graph(const SolutionRecord& record) {
        if (!has_lane_graph(record)) return {};
        ConeSet& set = cone_set(record);
        const auto graph = lane_graph_of(record, set.scene);
        if (const auto* fault = std::get_if<std::string>(&graph)) return {*fault};
        if (!record.objective) return {"there is no objective"};
        const CheckReport lane = check(set.scene, parameters_, std::get<LaneGraph>(graph));
        if (lane.violations.empty()) {
            set.learn({fmt::format("{} ({})", record.solver, record.formulation), lane.objective.value()});
        }
        std::vector<std::string> violations =
            check(set.scene, parameters_, std::get<LaneGraph>(graph),
                  {record.status == "optimal", *record.objective, record.bound})
                .violations;
        // A graph that is not a lane graph may have no point in the program.
        if (options_.exact && lane.violations.empty()) {
            if (auto fault = check_exactly(record, set.scene, std::get<LaneGraph>(graph)))
                violations.push_back(std::move(*fault));
        }
        return violations;
    }

    /// What rational arithmetic finds wrong with a lane graph that the checker accepts.
    std::optional<std::string> check_exactly(const SolutionRecord& record, const Scene& scene,
                                             const LaneGraph& graph) {
        std::optional<ExactProgramReport> exact;
        try {
            exact = recompute_exactly(scene, parameters_,
                                      record.formulation == "paper" ? Formulation::paper : Formulation::tight,
                                      graph);
        } catch (const std::invalid_argument& fault) {
            return fmt::format("in the {} program {}", record.formulation, fault.what());
        }
        if (!exact) {
            ++exact_.too_large;
            return std::nullopt;
        }
        const double difference = exact_difference(exact->objective, *record.objective);
        ++exact_.programs;
        exact_.rows += exact->rows;
        exact_.objective_difference = std::max(exact_.objective_difference, difference);
        exact_.objective_rounding = std::max(exact_.objective_rounding, exact->objective_rounding);
        exact_.row_rounding = std::max(exact_.row_rounding, exact->row_rounding);
        exact_.violation = std::max(exact_.violation, exact->violation);
        // The checker's tolerance of limits.
        if (exact->violation > 1e-9)
            return fmt::format("in rational arithmetic {} is violated by {:.3g}", exact->violated,
                               exact->violation);
        if (difference > 1e-9 * std::max(1.0, std::abs(*record.objective)))
            return fmt::format("in rational arithmetic the objective is {:.12g}, {:.3g} from the stated one",
                               exact->objective.convert_to<double>(), difference);
        return std::nullopt;
    }

    void print_exact() const {
        fmt::print(
            "{} lane graphs in rational arithmetic, {} rows; largest differences: {:.2g} of a stated "
            "objective, {:.2g} and {:.2g} of an objective's and of a row's sum in double; largest violation "
            "{:.2g}\n",
            exact_.programs, exact_.rows, exact_.objective_difference, exact_.objective_rounding,
            exact_.row_rounding, exact_.violation);
        if (exact_.too_large > 0) fmt::print("{} programs are too large for it\n", exact_.too_large);
    }

    /// What is wrong with a bound, an optimum or a claim that there is no lane graph, or why it is
    /// unverified.
    std::optional<std::string> check_proof(const SolutionRecord& record, bool& is_unverified) {
        const ConeSet& set = cone_set(record);
        if (record.bound && set.best) {
            const double best = set.best->objective;
            if (*record.bound > best + 1e-6 * std::max(1.0, std::abs(best))) {
                return fmt::format("{} claims the bound {:.6f}, but {} has the objective {:.6f}",
                                   record.solver, *record.bound, set.best->origin, best);
            }
        }
        if (record.status == "infeasible" && set.best) {
            return fmt::format("{} claims infeasible, but {} is a lane graph", record.solver,
                               set.best->origin);
        }
        if (record.status != "infeasible" && record.status != "optimal") return std::nullopt;
        return judge(record, set.scene, is_unverified);
    }

    /// What an own search says against an optimum or a claim that there is no lane graph.
    std::optional<std::string> judge(const SolutionRecord& record, const Scene& scene, bool& is_unverified) {
        const bool is_optimum = record.status == "optimal";
        const ClaimVerdict verdict = judge_bound(
            scene, parameters_, is_optimum ? *record.objective : std::numeric_limits<double>::infinity(),
            record.solver, options_.time_limit_ms);
        const std::string claim =
            is_optimum ? fmt::format("{} claims the optimum {:.6f}", record.solver, *record.objective)
                       : record.solver + " claims infeasible";
        switch (verdict.kind) {
            case ClaimVerdict::Kind::proven:
                ++proven_;
                return std::nullopt;
            case ClaimVerdict::Kind::unverified:
                is_unverified = true;
                return fmt::format(
                    "unverified: {}, which could be neither confirmed nor refuted within {} ms", claim,
                    options_.time_limit_ms);
            case ClaimVerdict::Kind::wrong:
                break;
        }
        std::vector<std::string> edges;
        for (const Edge& edge : verdict.witness->edges) {
            edges.push_back(fmt::format("[{}, {}]", scene.cones[edge.i].id, scene.cones[edge.j].id));
        }
        return fmt::format("{}, but {} found the lane graph [{}] with the objective {:.6f}", claim,
                           verdict.by, fmt::join(edges, ", "), *verdict.objective);
    }

    /// Prints and counts the scenes that a solver of the file left out.
    [[nodiscard]] std::size_t count_missing() const {
        if (options_.partial) return 0;
        std::map<std::pair<std::string, std::string>, std::set<std::string>> answered;
        for (const SolutionRecord& record : records_) {
            answered[{record.solver, record.formulation}].insert(record.scene);
        }
        std::size_t missing = 0;
        for (const auto& [solver, scenes] : answered) {
            for (const AnnotatedScene& annotated : scenes_.all()) {
                const std::string& scene = annotated.scene.id;
                if (scenes.contains(scene)) continue;
                fmt::print("{}: {} ({}) gives no answer\n", scene, solver.first, solver.second);
                ++missing;
            }
        }
        return missing;
    }

    const CheckOptions& options_;
    const RldParameters parameters_;
    const ScenesById scenes_;
    const std::vector<SolutionRecord> records_;
    std::map<std::pair<std::string, std::optional<std::size_t>>, ConeSet> cone_sets_;
    ExactTotals exact_;
    std::size_t proven_ = 0;
    std::size_t unverified_ = 0;
};

}  // namespace

void add_check_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand(
        "check",
        "recomputes solutions independently of the solvers; exit code 1 unless every claim is proven.\n"
        "Checked for each lane graph: every constraint, the objective, and that the bound is not above it. "
        "`optimal` and `infeasible` pass if they are proven within the time limit: by multipliers from the "
        "scene alone, for `infeasible` by the checker's own search, for path-pair by a certificate, or else "
        "by another exact solver. They fail if a lane graph of the file, of the ground truth or of that "
        "solver is better; otherwise they are unverified. The bound of `feasible` is not proven. A scene "
        "without an "
        "answer fails. `stopped` and `error` claim nothing and are counted separately.");
    auto options = std::make_shared<CheckOptions>();
    command.add_option("--scenes", options->scenes, "*.scenes.jsonl")->required();
    command.add_option("--solutions", options->solutions, "*.solutions.jsonl")->required();
    add_parameter_options(command, options->parameters, "the defaults");
    add_nearest_option(command, options->nearest, "cone-set size of `solve`, if the solutions do not say it");
    add_time_limit_option(command, options->time_limit_ms);
    command.add_flag("--exact", options->exact,
                     "also recompute objective, rows and bounds of the solver's program in rational "
                     "arithmetic, and print the largest differences; a violation above 1e-9 fails, and so "
                     "does an objective off by more than 1e-9 of max(1, |objective|)");
    command.add_flag("--partial", options->partial, "scenes without an answer do not fail");
    command.callback([options] {
        if (!Check(*options).run()) throw CLI::RuntimeError(1);
    });
}

}  // namespace conelane::program
