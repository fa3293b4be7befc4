// What the README shows: the lane between six cones and a stray one, "1 3 5 | 2 4 6", by both kinds of
// method.
#include "detectors/rld_detector.hpp"
#include "graph_search/clc_detector.hpp"
#include "solvers/registry.hpp"

#include <iostream>

int main() {
    conelane::Scene scene{"now", {{0.0, 0.0}, 0.0}, {}};  // pose, cones with ids
    scene.cones = {{1, {2, 1.6}},   {2, {2, -1.6}},   {3, {5.2, 1.6}}, {4, {5.2, -1.6}},
                   {5, {8.4, 1.6}}, {6, {8.4, -1.6}}, {7, {8, 9}}};
    auto rld = conelane::make_rld_detector(
        conelane::find_rld_solver("path-pair")->make(conelane::Formulation::tight),
        {.parameters = conelane::with_shape_costs({})});
    auto clc = conelane::make_clc_detector({});
    for (auto* detector : {rld.get(), clc.get()}) {
        const conelane::LaneAnswer answer = detector->detect(scene, {.time_limit_ms = 5000.0});
        for (const auto id : answer.lane.left) std::cout << id << ' ';
        std::cout << '|';
        for (const auto id : answer.lane.right) std::cout << ' ' << id;
        std::cout << '\n';
    }
}
