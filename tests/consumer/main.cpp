// The calls that the README shows: the lane between six cones and a stray one, its centre line, and the plan
// of a frame.
#include <iostream>

#include <conelane/planner.hpp>

int main() {
    conelane::Scene scene{.id = "now", .pose = {{0.0, 0.0}, 0.0}, .cones = {}};
    scene.cones = {{1, {2, 1.6}},   {2, {2, -1.6}},   {3, {5.2, 1.6}}, {4, {5.2, -1.6}},
                   {5, {8.4, 1.6}}, {6, {8.4, -1.6}}, {7, {8, 9}}};  // ids, positions [m]
    for (const char* name : {"clc", "rld-shape", "front"}) {
        auto detector = conelane::make_detector(name);
        const conelane::LaneAnswer answer = detector->detect(scene, {.time_limit_ms = 5000.0});
        if (answer.status != conelane::LaneStatus::found) return 1;
        for (const auto id : answer.lane.left) std::cout << id << ' ';
        std::cout << '|';
        for (const auto id : answer.lane.right) std::cout << ' ' << id;
        const conelane::DrivableLane lane = conelane::drivable(answer, scene);
        bool straight = !lane.points.empty();
        for (const auto& point : lane.points) straight = straight && std::abs(point.position.y()) < 1e-6;
        std::cout << (straight ? " straight\n" : " crooked\n");
    }
    auto planner = conelane::make_planner({.mission = conelane::Mission::autocross});
    const conelane::Frame frame{.time_s = 0.0, .pose = scene.pose, .cones = scene.cones};
    const conelane::Plan plan = planner->update(frame, {.time_limit_ms = 5000.0});
    std::cout << conelane::to_string(plan.state) << ' ' << plan.lane.points.empty() << '\n';
}
