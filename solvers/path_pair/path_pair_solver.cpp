#include "solvers/path_pair/path_pair_solver.hpp"

#include "solvers/core_entries.hpp"
#include "solvers/path_pair/search/branch_and_bound.hpp"

namespace conelane {
namespace {

using namespace path_pair;  // NOLINT(google-build-using-namespace): this file is its interface

// Labels are exact to less than this, so a smaller gap cannot be distinguished from 0.
constexpr double kMinGap = 1e-10;

class PathPairSolver : public RldSolver {
  public:
    explicit PathPairSolver(const PathPairOptions& options)
        : options_(options), incumbent_(graph_), search_(graph_, system_, incumbent_, options_, clock_) {}

    BoundCertificate certify(const LaneGraphProblem& problem, double time_limit_ms) {
        clock_.restart(Deadline(time_limit_ms));
        SearchClock no_limit;  // a certificate needs a graph
        graph_.build(problem, no_limit);
        incumbent_.reset(0.0, kMinGap);
        near_to_far(problem);
        BoundCertificate certificate;
        certificate.bound = search_.run_root();
        const Multipliers& multipliers = search_.root_multipliers();
        certificate.cone_multiplier = multipliers.cone;
        certificate.heading_multiplier = multipliers.heading;
        for (std::size_t q = 0; q < multipliers.clique.size(); ++q) {
            if (multipliers.clique[q] <= 0.0) continue;
            certificate.cliques.push_back(
                {clique_edges(problem, static_cast<int>(q)), multipliers.clique[q]});
        }
        return certificate;
    }

    SearchCertificate certify_search(const LaneGraphProblem& problem, const RldReport& report,
                                     double time_limit_ms) {
        SearchCertificate certificate{{}, report.lane_graph, report.objective, -kUnreachable};
        if (report.status == SolveStatus::infeasible) {
            certificate.bound = kUnreachable;
        } else if (report.bound && std::abs(*report.bound) < SearchCertificate::kMaxBound) {
            // Sums of doubles are off by less.
            certificate.bound = *report.bound - std::max(1e-9, 1e-12 * std::abs(*report.bound));
        }
        if (certificate.bound == -kUnreachable) return certificate;
        const Deadline deadline(time_limit_ms);
        SearchClock no_limit;
        graph_.build(problem, no_limit);
        for_each_system(problem, [&](const std::optional<std::size_t>& far_start) {
            certificate.parts.push_back(certify_part(problem, certificate.bound, deadline));
            certificate.parts.back().far_start = far_start;
        });
        return certificate;
    }

  private:
    using Outcome = BranchAndBound::Outcome;

    void run(const LaneGraphProblem& problem, const SolveArguments& arguments, RldReport& report) override {
        const Deadline deadline(arguments.limits.time_limit_ms);
        const Stopwatch build_watch;
        report.status = SolveStatus::stopped;
        SearchClock clock(deadline);
        if (is_too_large(problem)) {
            report.stopped_by = StopReason::memory;
        } else if (clock.out_of_time() || !graph_.build(problem, clock)) {
            report.stopped_by = StopReason::time;
        }
        report.build_ms = build_watch.elapsed_ms();
        if (report.stopped_by) return;
        const Stopwatch solve_watch;
        search(problem, arguments, deadline, report);
        report.solve_ms = solve_watch.elapsed_ms();
    }

    void search(const LaneGraphProblem& problem, const SolveArguments& arguments, const Deadline& deadline,
                RldReport& report) {
        // Two lane graphs differ by less than this. A larger gap has the same effect.
        const double most = cost_limit(problem);
        const double tolerance =
            std::max(std::min(arguments.limits.absolute_gap, most - graph_.share_bound()), kMinGap);
        search_.reset_nodes();
        const LaneGraph* const start = arguments.start;
        const bool start_is_feasible = start != nullptr && is_feasible(problem, *start);
        // Nearly every lane costs less than 0. Otherwise the scene is searched again, with a cutoff that
        // exceeds the cost of every lane by more than the tolerance.
        Outcome outcome{};
        for (const double cutoff : {0.0, most + tolerance}) {
            incumbent_.reset(cutoff, tolerance);
            if (start_is_feasible) offer(problem, *start);
            outcome = search(problem, deadline);
            ++report.rounds;
            if (incumbent_.found() || !outcome.complete) break;
        }
        report.nodes = search_.nodes();
        if (!outcome.complete) report.stopped_by = StopReason::time;
        if (incumbent_.found()) {
            report.status = outcome.complete ? SolveStatus::optimal : SolveStatus::feasible;
            report.lane_graph = lane_graph(problem);
            report.objective = objective(problem, *report.lane_graph);
            report.bound = std::min(outcome.bound, *report.objective);
        } else {
            report.status = outcome.complete ? SolveStatus::infeasible : SolveStatus::stopped;
            if (!outcome.complete) report.bound = outcome.bound;
        }
    }

    /// Offers the start as legs from near to far cones. Precondition: it is feasible.
    void offer(const LaneGraphProblem& problem, const LaneGraph& start) {
        std::array<std::vector<int>, 2> legs;
        const auto boundaries = paths(start, problem.cone_count);
        for (std::size_t leg = 0; leg < 2; ++leg) {
            std::vector<std::size_t> path = (*boundaries)[leg];
            if (!problem.near[path.front()]) std::ranges::reverse(path);
            for (std::size_t k = 0; k + 1 < path.size(); ++k) {
                legs[leg].push_back(graph_.arc(static_cast<int>(path[k]), static_cast<int>(path[k + 1])));
            }
        }
        incumbent_.offer(legs[0], legs[1]);
    }

    /// Above the cost of any lane graph by more than rounding.
    static double cost_limit(const LaneGraphProblem& problem) {
        double sum = 1.0;
        for (const ProblemEdge& edge : problem.edges) sum += edge.high_cost ? 0.0 : std::max(0.0, edge.cost);
        for (const ProblemTurn& turn : problem.turns) sum += turn.high_cost ? 0.0 : turn.cost;
        return sum * (1.0 + 1e-9);
    }

    /// Both legs from the near cones to the far ones.
    void near_to_far(const LaneGraphProblem& problem) {
        const std::size_t n = problem.cone_count;
        for (LegSystem::Kind& kind : system_.kinds) {
            kind.start.assign(n, 0);
            kind.end.assign(n, 0);
        }
        for (std::size_t cone = 0; cone < n; ++cone) {
            (problem.near[cone] ? system_.kinds[0].start : system_.kinds[0].end)[cone] = 1;
        }
        system_.kind_count = 1;
        system_.ends_are_partners = true;
    }

    /// Calls `visit(far_start)` for each system of legs, set up in `system_`: from near to far; and for the
    /// pairing `paper`, one leg between near cones and one between far ones, a system for each first end of
    /// the far leg, which is the cone of smaller index.
    template <typename Visit>
    void for_each_system(const LaneGraphProblem& problem, const Visit& visit) {
        near_to_far(problem);
        visit(std::nullopt);
        if (problem.parameters.pairing == Pairing::near_far) return;
        system_.kinds[0].end = system_.kinds[0].start;
        system_.kind_count = 2;
        system_.ends_are_partners = false;
        for (int cone = 0; cone < graph_.cone_count(); ++cone) {
            std::ranges::fill(system_.kinds[1].start, char{0});
            std::ranges::fill(system_.kinds[1].end, char{0});
            system_.kinds[1].start[static_cast<std::size_t>(cone)] = 1;
            bool any = false;
            for (const int partner : graph_.partners(cone)) {
                if (partner < cone) continue;
                system_.kinds[1].end[static_cast<std::size_t>(partner)] = 1;
                any = true;
            }
            if (any) visit(std::optional(static_cast<std::size_t>(cone)));
        }
    }

    Outcome search(const LaneGraphProblem& problem, const Deadline& deadline) {
        Outcome outcome{std::numeric_limits<double>::infinity(), true};
        for_each_system(problem, [&](const std::optional<std::size_t>&) {
            clock_.restart(deadline, options_.max_work);  // the limit of work is that of one search
            const Outcome part = search_.run();
            outcome.bound = std::min(outcome.bound, part.bound);
            outcome.complete = outcome.complete && part.complete;
        });
        return outcome;
    }

    /// The multipliers of the root, given the bound that the search proved.
    SearchCertificate::Part certify_part(const LaneGraphProblem& problem, double bound,
                                         const Deadline& deadline) {
        constexpr double kUnit = 1.0 / (1 << SearchCertificate::kFractionBits);
        SearchCertificate::Part part;
        // At least any verifier's upper bound of a lane graph's cost, however it splits the costs.
        const double best_end =
            problem.learned_end_cost.empty() ? 0.0 : std::ranges::min(problem.learned_end_cost);
        const double most = cost_limit(problem) + 2.0 * (problem.parameters.near_end_weight - best_end) *
                                                      static_cast<double>(problem.edges.size());
        const double cutoff = std::min(bound, most);
        // The margin makes sure that nothing is dropped here that exact arithmetic keeps.
        incumbent_.reset(cutoff + std::max(1e-7, 1e-10 * std::abs(cutoff)), 0.0);
        clock_.restart(deadline);
        const std::vector<Multipliers> stages = search_.run_root_in_stages(kUnit);
        const auto units = [](double multiplier) {
            constexpr auto kMax = static_cast<double>(SearchCertificate::kMaxUnits);
            return std::llround(std::min(multiplier / kUnit, kMax));
        };
        std::vector<std::size_t> place(static_cast<std::size_t>(search_.cliques().size()), 0);  // from 1
        for (const Multipliers& multipliers : stages) {
            SearchCertificate::Stage& stage = part.stages.emplace_back();
            for (const double multiplier : multipliers.cone) stage.cone.push_back(units(multiplier));
            stage.heading = units(multipliers.heading);
            for (std::size_t q = 0; q < multipliers.clique.size(); ++q) {
                if (multipliers.clique[q] <= 0.0) continue;
                if (place[q] == 0) {
                    part.cliques.push_back(clique_edges(problem, static_cast<int>(q)));
                    place[q] = part.cliques.size();
                }
                stage.clique.emplace_back(place[q] - 1, units(multipliers.clique[q]));
            }
        }
        return part;
    }

    [[nodiscard]] std::vector<Edge> clique_edges(const LaneGraphProblem& problem, int clique) const {
        return edges_of(problem, search_.cliques().edges(clique));
    }

    [[nodiscard]] LaneGraph lane_graph(const LaneGraphProblem& problem) const {
        LaneGraph graph{edges_of(problem, incumbent_.edges())};
        std::ranges::sort(graph.edges);
        return graph;
    }

    [[nodiscard]] std::vector<Edge> edges_of(const LaneGraphProblem& problem,
                                             std::span<const int> of_graph) const {
        std::vector<Edge> edges;
        for (const int edge : of_graph) {
            const ProblemEdge& e = problem.edges[graph_.problem_edge(edge)];
            edges.push_back({e.i, e.j});
        }
        return edges;
    }

    PathPairOptions options_;
    ArcGraph graph_;
    Incumbent incumbent_;
    LegSystem system_;
    SearchClock clock_;
    BranchAndBound search_;
};

}  // namespace

BoundCertificate certify_root_bound(const LaneGraphProblem& problem, double time_limit_ms) {
    // The multipliers alone have to carry the bound, so the incumbent must not drop anything.
    PathPairOptions options;
    options.fix_arcs = false;
    options.search_frontiers = false;
    return PathPairSolver(options).certify(problem, time_limit_ms);
}

SearchCertificate certify_search(const LaneGraphProblem& problem, double time_limit_ms) {
    PathPairSolver solver({});
    const RldReport report = solver.solve(problem, {.limits = {time_limit_ms}});
    PathPairOptions options;
    options.complete_walks = false;
    options.search_frontiers = false;
    return PathPairSolver(options).certify_search(problem, report, time_limit_ms);
}

std::unique_ptr<RldSolver> make_path_pair_solver(const PathPairOptions& options) {
    return std::make_unique<PathPairSolver>(options);
}

constexpr RldSolverEntry kPathPair{.name = "path-pair",
                                   .description = "exact branch and bound over pairs of paths",
                                   .traits = SolverTrait::exact,
                                   .make = [](Formulation) { return make_path_pair_solver(); }};

}  // namespace conelane
