#include "solvers/relaxation/lp_relaxation.hpp"

#include "model/lane_graph_model.hpp"
#include "solvers/detail/osi_program.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include <coin/ClpSimplex.hpp>
#include <coin/OsiClpSolverInterface.hpp>

namespace conelane {

LpRelaxation solve_lp_relaxation(const LaneGraphProblem& problem, const Deadline& deadline) {
    const LaneGraphModel model(problem, Formulation::tight);
    const BinaryProgram& program = model.program();
    LpRelaxation relaxation;
    if (deadline.passed()) return relaxation;
    if (program.columns.empty()) {
        relaxation.infeasible = true;
        return relaxation;
    }
    OsiClpSolverInterface interface;
    interface.messageHandler()->setLogLevel(0);
    ClpSimplex& lp = *interface.getModelPtr();
    lp.setLogLevel(0);
    (void)detail::load_into(interface, program);
    lp.setMaximumWallSeconds(std::max(0.0, deadline.remaining_ms()) / 1000.0);
    lp.dual();
    relaxation.infeasible = lp.isProvenPrimalInfeasible();
    if (!lp.isProvenOptimal()) return relaxation;
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
