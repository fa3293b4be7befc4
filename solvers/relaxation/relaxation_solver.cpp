#include "solvers/relaxation/relaxation_solver.hpp"

#include "conelane/relaxation_solvers.hpp"
#include "model/lane_graph_model.hpp"
#include "solvers/milp/detail/osi_program.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"

#include <map>

#include <coin/ClpConfig.h>
#include <coin/ClpSimplex.hpp>

namespace conelane {
namespace {

/// Where a row of EdgeRelaxation has no limit.
constexpr double kUnlimited = std::numeric_limits<double>::infinity();

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
        rounded.stopped_by = found.stopped_by;
        if (!found.lane_graph && found.stopped_by) return rounded;
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

std::optional<LinearRelaxation> linear_relaxation(const BinaryProgram& program) {
    OsiClpSolverInterface lp;
    lp.messageHandler()->setLogLevel(0);
    lp.getModelPtr()->setLogLevel(0);
    detail::load_into(lp, program);
    lp.initialSolve();
    if (!lp.isProvenOptimal()) return std::nullopt;
    LinearRelaxation relaxation{lp.getObjValue(), true};
    for (std::size_t c = 0; c < program.columns.size(); ++c) {
        const double value = lp.getColSolution()[c];
        if (program.columns[c].integer && std::abs(value - std::round(value)) > 1e-6)
            relaxation.is_integral = false;
    }
    return relaxation;
}

EdgeRelaxation::EdgeRelaxation(const LaneGraphProblem& problem)
    : cone_count_(problem.cone_count), problem_edges_(problem.edges.size()) {
    std::vector<int> variable_of(problem.edges.size(), -1);
    for (std::size_t e = 0; e < problem.edges.size(); ++e) {
        const ProblemEdge& edge = problem.edges[e];
        if (edge.high_cost) continue;
        variable_of[e] = static_cast<int>(edges_.size());
        edges_.push_back(e);
        ends_.emplace_back(static_cast<int>(edge.i), static_cast<int>(edge.j));
        costs_.push_back(edge.cost);
    }
    add_path_rows(problem);
    const auto exclude = [&](std::size_t first, std::size_t second) {
        rows_.push_back({{{variable_of[first], 1.0}, {variable_of[second], 1.0}}, -kUnlimited, 1.0});
    };
    for (const auto& [first, second] : problem.conflicts) {  // (6)-(8)
        if (variable_of[first] >= 0 && variable_of[second] >= 0) exclude(first, second);
    }
    for (const ProblemTurn& turn : problem.turns) {
        const int first = variable_of[turn.edge_i];
        const int second = variable_of[turn.edge_k];
        if (first < 0 || second < 0) continue;
        if (turn.high_cost) {
            exclude(turn.edge_i, turn.edge_k);  // (28)
        } else {
            products_.push_back({std::min(first, second), std::max(first, second), turn.cost});
        }
    }
}

void EdgeRelaxation::add_path_rows(const LaneGraphProblem& problem) {
    const auto g = [&](std::size_t cone) { return static_cast<int>(edges_.size() + cone); };
    std::vector<std::vector<std::pair<int, double>>> degree(cone_count_);  // A_i
    for (std::size_t a = 0; a < ends_.size(); ++a) {
        for (const int end : {ends_[a].first, ends_[a].second}) {
            degree[static_cast<std::size_t>(end)].emplace_back(static_cast<int>(a), 1.0);
        }
    }
    // Sum of factor * (A_i - 2 g_i) over some cones.
    const auto sum_of_ends = [&](const std::vector<std::size_t>& cones, double factor) {
        std::vector<double> sum(variables(), 0.0);
        for (const std::size_t cone : cones) {
            for (const auto& [variable, one] : degree[cone]) {
                sum[static_cast<std::size_t>(variable)] += factor * one;
            }
            sum[static_cast<std::size_t>(g(cone))] -= 2.0 * factor;
        }
        std::vector<std::pair<int, double>> terms;
        for (std::size_t v = 0; v < sum.size(); ++v) {
            if (sum[v] != 0.0) terms.emplace_back(static_cast<int>(v), sum[v]);
        }
        return terms;
    };
    std::vector<std::size_t> all;
    std::vector<std::size_t> near;
    for (std::size_t cone = 0; cone < cone_count_; ++cone) {
        all.push_back(cone);
        if (problem.near[cone]) near.push_back(cone);
        rows_.push_back({sum_of_ends({cone}, 1.0), -kUnlimited, 0.0});  // (2)
        std::vector<std::pair<int, double>> chosen = degree[cone];      // (1)
        chosen.emplace_back(g(cone), -1.0);
        rows_.push_back({std::move(chosen), 0.0, kUnlimited});
    }
    rows_.push_back({sum_of_ends(all, 1.0), -4.0, -4.0});    // (3)
    rows_.push_back({sum_of_ends(near, -1.0), 2.0, 2.0});    // (11)
    for (const auto& [first, second] : problem.far_apart) {  // (12)-(17)
        rows_.push_back({sum_of_ends({first, second}, -1.0), -kUnlimited, 1.0});
    }
    Row heading{{}, 2.0, kUnlimited};  // (9)
    for (std::size_t a = 0; a < edges_.size(); ++a) {
        if (problem.edges[edges_[a]].along_heading) heading.terms.emplace_back(static_cast<int>(a), 1.0);
    }
    rows_.push_back(std::move(heading));
}

double EdgeRelaxation::objective(std::span<const double> x) const {
    double sum = 0.0;
    for (std::size_t a = 0; a < costs_.size(); ++a) sum += costs_[a] * x[a];
    for (const Product& product : products_) {
        sum += product.factor * x[static_cast<std::size_t>(product.first)] *
               x[static_cast<std::size_t>(product.second)];
    }
    return sum;
}

void EdgeRelaxation::gradient(std::span<const double> x, std::span<double> result) const {
    std::ranges::fill(result, 0.0);
    std::ranges::copy(costs_, result.begin());
    for (const Product& product : products_) {
        const auto first = static_cast<std::size_t>(product.first);
        const auto second = static_cast<std::size_t>(product.second);
        result[first] += product.factor * x[second];
        result[second] += product.factor * x[first];
    }
}

std::vector<double> EdgeRelaxation::point(std::span<const double> edge_values) const {
    std::vector<double> x(variables(), 0.0);
    for (std::size_t a = 0; a < edges_.size(); ++a) {
        x[a] = edge_values[edges_[a]];
        for (const int end : {ends_[a].first, ends_[a].second}) {
            x[edges_.size() + static_cast<std::size_t>(end)] += 0.5 * x[a];
        }
    }
    for (double& value : x) value = std::clamp(value, 0.0, 1.0);
    return x;
}

std::vector<double> EdgeRelaxation::edge_values(std::span<const double> x) const {
    std::vector<double> values(problem_edges_, 0.0);
    for (std::size_t a = 0; a < edges_.size(); ++a) values[edges_[a]] = x[a];
    return values;
}

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
