#include "conelane/check.hpp"
#include "conelane/invalid_input.hpp"
#include "conelane/solve_scene.hpp"
#include "evaluation/proofs/certificate_verifier.hpp"
#include "evaluation/proofs/lane_graph_search.hpp"
#include "experiments/cross_check/cross_check.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"
#include "solvers/registry.hpp"

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_int_distribution.hpp>
#include <fmt/format.h>

namespace conelane::experiments {
namespace {

constexpr double kTolerance = 1e-6;
constexpr double kOwnSearch_ms = 20.0;
constexpr double kTravelOfAFrame_m = 1.0;
constexpr std::size_t kMaxCertifiedCones = 12;
constexpr std::int64_t kMaxCertificateSteps = 20'000;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

enum class Asked { generously, tightly, from_a_start };

/// A claim, and how the question was asked.
struct Answer {
    std::string by;
    Asked asked;
    RldReport report;
};

struct NamedStart {
    std::string name;
    LaneGraph graph;
};

/// Most edges of a lane graph and a few others: rarely a lane graph itself.
LaneGraph random_edges(const LaneGraph& from, std::size_t cones, std::size_t seed) {
    boost::random::mt19937_64 random(seed);
    const auto one_in = [&](int count) {
        return boost::random::uniform_int_distribution<int>(1, count)(random) == 1;
    };
    LaneGraph graph;
    for (std::size_t i = 0; i < cones; ++i) {
        for (std::size_t j = i + 1; j < cones; ++j) {
            const bool is_in_answer = std::ranges::find(from.edges, Edge{i, j}) != from.edges.end();
            if (is_in_answer ? !one_in(4) : one_in(static_cast<int>(2 * cones)))
                graph.edges.push_back({i, j});
        }
    }
    return graph;
}

bool is_proof(const RldReport& report) {
    return report.status == SolveStatus::optimal || report.status == SolveStatus::infeasible;
}

class Judgement {
  public:
    Judgement(const CrossCheckCase& drawn, std::span<const CheckedSolver> solvers, double time_limit_ms)
        : drawn_(drawn), solvers_(solvers), time_limit_ms_(time_limit_ms) {}

    CrossCheckVerdict run() {
        ask(time_limit_ms_, Asked::generously);
        ask(drawn_.tight_limit_ms, Asked::tightly);
        ask_from_starts();
        for (const Answer& answer : answers_) hold_against_itself(answer);
        hold_against_each_other();
        conclude();
        if (verdict_.outcome == CrossCheckOutcome::infeasible) search_without_solvers();
        if (drawn_.scene.cones.size() <= kMaxCertifiedCones) repeat_proof();
        if (!verdict_.findings.empty()) verdict_.outcome = CrossCheckOutcome::differ;
        return std::move(verdict_);
    }

  private:
    template <typename... Values>
    void find(fmt::format_string<Values...> text, Values&&... values) {
        verdict_.findings.push_back(fmt::format(text, std::forward<Values>(values)...));
    }

    void ask(double limit_ms, Asked asked) {
        for (const CheckedSolver& solver : solvers_) {
            if (solver.max_cones && drawn_.scene.cones.size() > *solver.max_cones) continue;
            answers_.push_back({fmt::format("{} within {} ms", solver.name, limit_ms), asked,
                                solver.solve(drawn_.scene, drawn_.parameters, {.limits = {limit_ms}})});
        }
    }

    /// The first solver's lane graph of the frame before, when the car stood a metre behind. Cones and
    /// edges are those of this frame; near ends and headings may differ.
    [[nodiscard]] std::optional<LaneGraph> answer_of_previous_frame() const {
        if (solvers_.empty()) return std::nullopt;
        const CheckedSolver& first = solvers_.front();
        if (first.max_cones && drawn_.scene.cones.size() > *first.max_cones) return std::nullopt;
        Scene previous = drawn_.scene;
        previous.pose.position -= kTravelOfAFrame_m * previous.pose.heading();
        return first.solve(previous, drawn_.parameters, {.limits = {time_limit_ms_}}).lane_graph;
    }

    /// The starts for the solver of this name.
    [[nodiscard]] std::vector<NamedStart> starts(const std::string& name,
                                                 const std::optional<LaneGraph>& previous) const {
        std::vector<NamedStart> all;
        const std::size_t cones = drawn_.scene.cones.size();
        const LaneGraph* known = nullptr;
        for (const Answer& answer : answers_) {
            if (answer.asked != Asked::generously || !answer.report.lane_graph) continue;
            const bool is_own = answer.by.starts_with(name + " within ");
            if (known == nullptr || is_own) known = &*answer.report.lane_graph;
            const bool has_other = !all.empty() && all.back().name == "another's answer";
            if (!is_own && !has_other) all.push_back({"another's answer", *answer.report.lane_graph});
        }
        all.push_back({"random edges", random_edges(known ? *known : LaneGraph{}, cones, drawn_.number)});
        if (previous) all.push_back({"the previous frame's answer", *previous});
        if (known == nullptr || known->edges.empty()) return all;
        all.push_back({"its own answer", *known});
        LaneGraph shorter = *known;
        shorter.edges.pop_back();
        all.push_back({"an answer without its last edge", std::move(shorter)});
        LaneGraph with_gone = *known;
        with_gone.edges.push_back({cones - 1, cones});
        all.push_back({"an answer with a cone that is gone", std::move(with_gone)});
        return all;
    }

    void ask_from_starts() {
        const LaneGraphProblem problem = make_problem(drawn_.scene, drawn_.parameters);
        const std::optional<LaneGraph> previous = answer_of_previous_frame();
        for (const CheckedSolver& solver : solvers_) {
            if (!solver.takes_starts) continue;
            if (solver.max_cones && drawn_.scene.cones.size() > *solver.max_cones) continue;
            for (const NamedStart& start : starts(solver.name, previous)) {
                const bool is_feasible_start = is_feasible(problem, start.graph);
                std::vector<double> limits{drawn_.tight_limit_ms};
                if (start.name == "its own answer") limits.push_back(time_limit_ms_);
                for (const double limit_ms : limits) {
                    Answer answer{fmt::format("{} within {} ms from {}", solver.name, limit_ms, start.name),
                                  Asked::from_a_start,
                                  solver.solve(drawn_.scene, drawn_.parameters,
                                               {.limits = {limit_ms}, .start = &start.graph})};
                    if (is_feasible_start) hold_against_start(answer, objective(problem, start.graph));
                    answers_.push_back(std::move(answer));
                }
            }
        }
    }

    void hold_against_start(const Answer& answer, double known) {
        // If the limit ends while the problem is made, the solver answers without checking the start.
        if (answer.report.status == SolveStatus::stopped) return;
        if (!answer.report.objective ||
            *answer.report.objective > known + kTolerance * std::max(1.0, std::abs(known)))
            find("{}: {}, worse than the start's {}", answer.by, to_string(answer.report.status), known);
    }

    void hold_against_itself(const Answer& answer) {
        const RldReport& report = answer.report;
        const std::string status(to_string(report.status));
        if (report.status == SolveStatus::error) return find("{}: error, {}", answer.by, report.message);
        const bool wants_graph =
            report.status == SolveStatus::optimal || report.status == SolveStatus::feasible;
        if (wants_graph != report.lane_graph.has_value() || wants_graph != report.objective.has_value())
            return find("{}: {} with{} a lane graph", answer.by, status, report.lane_graph ? "" : "out");
        if (report.bound && std::isnan(*report.bound)) find("{}: a bound that is not a number", answer.by);
        if (report.status == SolveStatus::optimal && !report.bound)
            find("{}: optimal without a bound", answer.by);
        if (!report.lane_graph) return;
        const Claim claim{report.status == SolveStatus::optimal, *report.objective, report.bound};
        for (const std::string& violation :
             check(drawn_.scene, drawn_.parameters, *report.lane_graph, claim).violations) {
            find("{}: {}", answer.by, violation);
        }
    }

    static double lower(const RldReport& report) {
        if (report.status == SolveStatus::infeasible) return kInfinity;
        return report.bound.value_or(-kInfinity);
    }

    void hold_against_each_other() {
        for (const Answer& proof : answers_) {
            for (const Answer& other : answers_) {
                if (!other.report.objective) continue;
                const double upper = *other.report.objective;
                if (!(lower(proof.report) > upper + kTolerance * std::max(1.0, std::abs(upper)))) continue;
                find("{}: {}, bound {}; but {}: {}, objective {}", proof.by, to_string(proof.report.status),
                     lower(proof.report), other.by, to_string(other.report.status), upper);
            }
        }
    }

    void conclude() {
        bool all_optimal = true;
        bool all_infeasible = true;
        for (const Answer& answer : answers_) {
            if (answer.asked == Asked::generously) {
                all_optimal = all_optimal && answer.report.status == SolveStatus::optimal;
                all_infeasible = all_infeasible && answer.report.status == SolveStatus::infeasible;
            } else if (answer.asked == Asked::tightly) {
                ++verdict_.tight_answers;
                if (is_proof(answer.report)) ++verdict_.tight_proofs;
            }
        }
        if (answers_.empty()) return;
        const RldReport& first = answers_.front().report;
        if (first.status == SolveStatus::optimal) verdict_.objective = first.objective;
        if (all_optimal) verdict_.outcome = CrossCheckOutcome::same_optimum;
        if (all_infeasible) verdict_.outcome = CrossCheckOutcome::infeasible;
    }

    void search_without_solvers() {
        const auto search = search_lane_graph(drawn_.scene, drawn_.parameters, kOwnSearch_ms);
        if (search.witness) find("all: infeasible; but the checker's own search has a lane graph");
    }

    void repeat_proof() {
        const SearchCertificate certificate =
            certify_search(make_problem(drawn_.scene, drawn_.parameters), time_limit_ms_);
        const SearchVerdict proof =
            verify_search(drawn_.scene, drawn_.parameters, certificate, kMaxCertificateSteps);
        if (proof.kind == SearchVerdict::Kind::refused && certificate.bound > -kInfinity)
            find("the certificate of path-pair is refused: {}", proof.reason);
        verdict_.certified = proof.kind == SearchVerdict::Kind::verified;
    }

    const CrossCheckCase& drawn_;
    std::span<const CheckedSolver> solvers_;
    double time_limit_ms_;
    std::vector<Answer> answers_;
    CrossCheckVerdict verdict_;
};

}  // namespace

std::vector<std::string> exact_solver_names() {
    std::vector<std::string> names;
    for (const RldSolverEntry& solver : rld_solvers()) {
        if (solver.has(SolverTrait::exact)) names.emplace_back(solver.name);
    }
    return names;
}

std::vector<CheckedSolver> make_checked_solvers(std::span<const std::string> names, Formulation formulation) {
    std::vector<CheckedSolver> solvers;
    for (const std::string& name : names) {
        const RldSolverEntry* const entry = find_rld_solver(name);
        if (entry == nullptr || !entry->has(SolverTrait::exact))
            throw InvalidInput("--solvers", "'" + name + "' is not an exact solver of this build");
        const std::shared_ptr<RldSolver> solver = entry->make(formulation);
        solvers.push_back(
            {entry->has(SolverTrait::uses_formulation) ? fmt::format("{} ({})", name, to_string(formulation))
                                                       : name,
             [solver](const Scene& scene, const RldParameters& parameters, const SolveArguments& arguments) {
                 return solve_scene(*solver, scene, parameters, arguments).report;
             },
             entry->max_cones, true});
    }
    return solvers;
}

std::string_view to_string(CrossCheckOutcome outcome) {
    constexpr std::array<std::string_view, 4> kNames{"same optimum", "infeasible", "undecided", "differ"};
    return kNames.at(static_cast<std::size_t>(outcome));
}

CrossCheckVerdict judge(const CrossCheckCase& drawn, std::span<const CheckedSolver> solvers,
                        double time_limit_ms) {
    return Judgement(drawn, solvers, time_limit_ms).run();
}

}  // namespace conelane::experiments
