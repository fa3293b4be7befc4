#include "solvers/relaxation/lp_relaxation.hpp"

#include "model/lane_graph_model.hpp"
#include "solvers/detail/coin_deadline.hpp"
#include "solvers/detail/osi_program.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <utility>

#include <coin/ClpSimplex.hpp>
#include <coin/OsiClpSolverInterface.hpp>

namespace conelane {

LpRelaxation solve_lp_relaxation(const LaneGraphProblem& problem, const Deadline& deadline) {
    LpRelaxation relaxation;
    LaneGraphModel model(Formulation::tight);
    relaxation.stopped_by = model.update(problem, deadline);
    if (relaxation.stopped_by) return relaxation;
    const BinaryProgram& program = model.program();
    if (problem.edges.empty()) {
        relaxation.infeasible = true;
        return relaxation;
    }
    detail::DeadlineWatch watch{deadline};
    OsiClpSolverInterface interface;
    ClpSimplex& lp = *interface.getModelPtr();
    detail::with_std_errors([&] {
        detail::prepare(interface, watch);
        (void)detail::load_into(interface, program);
        if (!watch.strikes()) lp.dual();
    });
    if (watch.struck) {
        relaxation.stopped_by = StopReason::time;
        return relaxation;
    }
    relaxation.infeasible = lp.isProvenPrimalInfeasible();
    if (relaxation.infeasible) return relaxation;
    if (!lp.isProvenOptimal()) throw std::runtime_error("Clp could not solve the relaxation");
    relaxation.bound = lp.objectiveValue();
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> edge_of;
    for (std::size_t e = 0; e < problem.edges.size(); ++e) {
        edge_of.emplace(std::pair(problem.edges[e].i, problem.edges[e].j), e);
    }
    relaxation.edge_values.assign(problem.edges.size(), 0.0);
    for (std::size_t column = 0; column < program.columns.size(); ++column) {
        const Label& label = program.columns[column].label;
        if (label.family != "a") continue;
        const auto i = static_cast<std::size_t>(std::min(label.index.first, label.index.second));
        const auto j = static_cast<std::size_t>(std::max(label.index.first, label.index.second));
        relaxation.edge_values[edge_of.at({i, j})] = lp.primalColumnSolution()[column];
    }
    return relaxation;
}

}  // namespace conelane
