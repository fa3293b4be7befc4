// Prints the lane of four cones and a stray one: "1 3 | 2 4".
#include "model/lane_graph.hpp"
#include "model/scene.hpp"

#include <iostream>

int main() {
    conelane::Scene scene;
    scene.cones = {{1, {2, 2}}, {2, {2, -2}}, {3, {6, 2}}, {4, {6, -2}}, {5, {40, 30}}};
    const auto near = conelane::nearest_ahead(scene, 4);
    const auto lane = conelane::to_lane({{{0, 2}, {1, 3}}}, near);
    if (!lane) return 1;
    for (const auto id : lane->left) std::cout << id << ' ';
    std::cout << '|';
    for (const auto id : lane->right) std::cout << ' ' << id;
    std::cout << '\n';
}
