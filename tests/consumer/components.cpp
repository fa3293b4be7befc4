// The components: one scene, the same optimum by the exact search, by CBC and by rounding.
#include <iostream>

#include <conelane/milp_solvers.hpp>
#include <conelane/relaxation_solvers.hpp>
#include <conelane/solve_scene.hpp>

int main() {
    conelane::Scene scene{.id = "now", .pose = {{0.0, 0.0}, 0.0}, .cones = {}};
    scene.cones = {{1, {2, 1.6}},   {2, {2, -1.6}},   {3, {5.2, 1.6}}, {4, {5.2, -1.6}},
                   {5, {8.4, 1.6}}, {6, {8.4, -1.6}}, {7, {8, 9}}};
    for (const auto& solvers :
         {conelane::core_solvers(), conelane::milp_solvers(), conelane::relaxation_solvers()}) {
        const auto solver = solvers.front().make(conelane::Formulation::tight);
        const conelane::SolvedScene solved = conelane::solve_scene(*solver, scene, {}, {});
        std::cout << solvers.front().name << ' ' << std::round(solved.report.objective.value_or(0.0)) << '\n';
    }
}
