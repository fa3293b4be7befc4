#include "solvers/relaxation/relaxation_solver.hpp"

#include "conelane/relaxation_solvers.hpp"
#include "model/deadline.hpp"
#include "model/lane_graph_model.hpp"
#include "solvers/milp/detail/coin_deadline.hpp"
#include "solvers/milp/detail/osi_program.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <stdexcept>
#include <utility>

#include <coin/ClpConfig.h>
#include <coin/ClpSimplex.hpp>
#include <coin/OsiClpSolverInterface.hpp>

namespace conelane {
namespace {

/// The linear relaxation of the tight formulation without its lazy rows.
struct LpRelaxation {
    bool infeasible = false;      ///< proven: the problem has no lane graph
    std::optional<double> bound;  ///< its optimum, a lower bound of the problem; absent if stopped
    std::optional<StopReason> stopped_by;
    std::vector<double> edge_values;  ///< a_ij by problem edge, with the bound
};

/// a_ij of a point by problem edge. Precondition: the problem lists only the candidates.
std::vector<double> edge_values_of(const LaneGraphProblem& problem, const BinaryProgram& program,
                                   const double* point) {
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> edge_of;
    for (std::size_t e = 0; e < problem.edges.size(); ++e) {
        edge_of.emplace(std::pair(problem.edges[e].i, problem.edges[e].j), e);
    }
    std::vector<double> values(problem.edges.size(), 0.0);
    for (std::size_t column = 0; column < program.columns.size(); ++column) {
        const Label& label = program.columns[column].label;
        if (label.family != "a") continue;
        const auto [i, j] = std::minmax(label.index.first, label.index.second);
        values[edge_of.at({static_cast<std::size_t>(i), static_cast<std::size_t>(j)})] = point[column];
    }
    return values;
}

/// Solved by Clp; throws std::runtime_error if that fails.
LpRelaxation solve_lp_relaxation(const LaneGraphProblem& problem, const Deadline& deadline) {
    LpRelaxation relaxation;
    LaneGraphModel model(Formulation::tight);
    relaxation.stopped_by = model.update(problem, deadline);
    if (relaxation.stopped_by) return relaxation;
    if (problem.edges.empty()) {
        relaxation.infeasible = true;
        return relaxation;
    }
    detail::DeadlineWatch watch{deadline};
    OsiClpSolverInterface interface;
    ClpSimplex& lp = *interface.getModelPtr();
    detail::with_std_errors([&] {
        detail::prepare(interface, watch);
        (void)detail::load_into(interface, model.program());
        if (!watch.must_stop()) lp.dual();
    });
    if (watch.interrupted) {
        relaxation.stopped_by = StopReason::time;
        return relaxation;
    }
    relaxation.infeasible = lp.isProvenPrimalInfeasible();
    if (relaxation.infeasible) return relaxation;
    if (!lp.isProvenOptimal()) throw std::runtime_error("Clp could not solve the relaxation");
    relaxation.bound = lp.objectiveValue();
    relaxation.edge_values = edge_values_of(problem, model.program(), lp.primalColumnSolution());
    return relaxation;
}

constexpr std::array<double, 5> kFavoured{0.5, 0.2, 0.05, 0.01, 0.001};

/// The cheapest lane graph among the edges that a relaxation favours: those with a value of at least the
/// first of kFavoured; if they hold no lane graph, of at least the next. path-pair searches each set
/// completely. The report is feasible, with objective and lane graph, or stopped; it has no bound.
RldReport round_by_search(const LaneGraphProblem& problem, std::span<const double> edge_values,
                          RldSolver& path_pair, const Deadline& deadline, double absolute_gap) {
    RldReport rounded;
    rounded.status = SolveStatus::stopped;
    for (const double least : kFavoured) {
        if (deadline.passed()) {
            rounded.stopped_by = StopReason::time;
            return rounded;
        }
        LaneGraphProblem favoured = problem;
        for (std::size_t e = 0; e < problem.edges.size(); ++e) {
            if (edge_values[e] < least) favoured.edges[e].high_cost = true;
        }
        const RldReport found =
            path_pair.solve(favoured, {.limits = {deadline.remaining_ms(), absolute_gap}});
        rounded.nodes += found.nodes;
        if (!found.lane_graph) continue;
        rounded.status = SolveStatus::feasible;
        rounded.lane_graph = found.lane_graph;
        rounded.objective = found.objective;
        return rounded;
    }
    rounded.status = SolveStatus::error;
    rounded.message = "the edges that the relaxation favours hold no lane graph";
    return rounded;
}

class RelaxationSolver : public RldSolver {
  public:
    explicit RelaxationSolver(Relax relax) : relax_(std::move(relax)) {}

  private:
    void run(const LaneGraphProblem& problem, const SolveArguments& arguments, RldReport& report) override {
        const Deadline deadline(arguments.limits.time_limit_ms);
        const Stopwatch watch;
        relax_and_round(problem, arguments.limits.absolute_gap, deadline, report);
        report.rounds = 1;
        report.solve_ms = watch.elapsed_ms();
    }

    void relax_and_round(const LaneGraphProblem& problem, double absolute_gap, const Deadline& deadline,
                         RldReport& report) {
        const LpRelaxation linear = solve_lp_relaxation(problem, deadline);
        report.bound = linear.bound;
        if (!linear.bound) {
            report.status = linear.infeasible ? SolveStatus::infeasible : SolveStatus::stopped;
            report.stopped_by = linear.stopped_by;
            return;
        }
        const auto values = relax_(problem, linear.edge_values, deadline);
        if (!values) {
            report.status = SolveStatus::stopped;
            report.stopped_by = StopReason::time;
            return;
        }
        report = round_by_search(problem, *values, *path_pair_, deadline, absolute_gap);
        report.bound = linear.bound;
    }

    Relax relax_;
    std::unique_ptr<RldSolver> path_pair_ = make_path_pair_solver();
};

}  // namespace

std::unique_ptr<RldSolver> make_relaxation_solver(Relax relax) {
    return std::make_unique<RelaxationSolver>(std::move(relax));
}

/// The baseline of relaxations: the linear relaxation as it is.
constexpr RldSolverEntry kLpRounding{
    .name = "lp-rounding",
    .description = "Clp's relaxation, rounded; no proof",
    .traits = SolverTrait::refuses_huge_costs,
    .make =
        [](Formulation) {
            return make_relaxation_solver([](const LaneGraphProblem& /*problem*/,
                                             const std::vector<double>& linear,
                                             const Deadline& /*deadline*/) { return linear; });
        },
    .library = "Clp " CLP_VERSION};

std::span<const RldSolverEntry> relaxation_solvers() {
    static const std::array kSolvers{kLpRounding, kNlopt, kIpopt};
    return kSolvers;
}

}  // namespace conelane
