// A program from outside for the tests: `outside_child SHAPE [FAULT K MARKER]`. It answers like `clc`, in a
// shape: cone ids, points on the cones, points beside them, or a centre line. At the K-th scene it commits
// the fault, but only if the file MARKER does not exist, which it then creates. It writes its input to the
// file named by OUTSIDE_LOG, and its process number to OUTSIDE_PID.

#include "tests/evaluation/outside/process_faults.hpp"

#include <fstream>
#include <map>

#include <conelane/detectors.hpp>
#include <nlohmann/json.hpp>

namespace {

using conelane::Point;
using conelane::tests::commit_process_fault;
using conelane::tests::sleep_on;
using nlohmann::json;

Point position(const json& from) {
    return {from.at("x").get<double>(), from.at("y").get<double>()};
}

conelane::Scene scene_of(const json& line) {
    conelane::Scene scene{line.at("id"), {position(line.at("pose")), line.at("pose").at("yaw")}, {}};
    for (const json& cone : line.at("cones")) scene.cones.push_back({cone.at("id"), position(cone)});
    return scene;
}

json points(const std::vector<conelane::ConeId>& ids, const conelane::Scene& scene, const Point& beside) {
    json all = json::array();
    for (const conelane::ConeId id : ids) {
        for (const conelane::Cone& cone : scene.cones) {
            if (cone.id == id)
                all.push_back({cone.position.x() + beside.x(), cone.position.y() + beside.y()});
        }
    }
    return all;
}

json answer_to(const conelane::Scene& scene, const conelane::LaneAnswer& answer, const std::string& shape) {
    json line{{"scene", scene.id}, {"status", to_string(answer.status)}, {"latency_ms", 0.25}};
    const conelane::Lane& lane = answer.lane;
    if (answer.status != conelane::LaneStatus::found) return line;
    line["closed"] = lane.closed;
    if (shape == "ids") {
        line["left"] = lane.left;
        line["right"] = lane.right;
    } else if (shape == "centre-line") {
        line["centre_line"] = json::array();
        for (const conelane::DrivablePoint& point : drivable(lane, scene).points)
            line["centre_line"].push_back({point.position.x(), point.position.y()});
    } else {
        const Point beside = shape == "points" ? Point(0.1, -0.1) : Point(0.3, 0.3);
        line["left_points"] = points(lane.left, scene, beside);
        line["right_points"] = points(lane.right, scene, beside);
    }
    return line;
}

void say(const std::string& line) {
    std::cout << line << std::endl;
}

/// Commits the fault. Returns the answer, if the program continues.
void commit(const std::string& fault, const json& right, const conelane::Scene& scene) {
    json wrong = right;
    commit_process_fault(fault, R"({"scene": ")");
    if (fault == "endless-errors") {
        for (const std::string block(65536, 'x');;) std::cerr << block << std::flush;
    }
    if (fault == "closed-streams") {
        ::close(STDIN_FILENO);
        ::close(STDOUT_FILENO);
        sleep_on();
    }
    if (fault == "forked") {  // the child keeps the streams, and the parent ends
        if (::fork() == 0) sleep_on();
        std::_Exit(0);
    }
    if (fault == "nonsense") return say("lane: left, then right");
    if (fault == "array") return say("[1, 2]");
    if (fault == "nan")
        return say(R"({"scene": ")" + scene.id + R"(", "status": "none", "latency_ms": NaN})");
    if (fault == "wrong-scene") wrong["scene"] = "another";
    if (fault == "no-scene") wrong.erase("scene");
    if (fault == "unknown-id") wrong["left"] = {987654321};
    if (fault == "cone-twice") wrong["left"] = {scene.cones[0].id, scene.cones[0].id};
    if (fault == "wrong-type") wrong["left"] = "all of them";
    if (fault == "lane-of-none") wrong["status"] = "none";
    if (fault == "far-point") {
        wrong.erase("left");
        wrong.erase("right");
        wrong["left_points"] = {{1e300, 0.0}, {1.0, 1.0}};
        wrong["right_points"] = json::array();
    }
    say(wrong.dump());
    if (fault == "two-lines") say(wrong.dump());
}

}  // namespace

int main(int argument_count, char** arguments) {
    const std::vector<std::string> words(arguments + 1, arguments + argument_count);
    std::ofstream log;
    if (const char* const file = std::getenv("OUTSIDE_LOG")) log.open(file, std::ios::app);
    if (const char* const file = std::getenv("OUTSIDE_PID")) std::ofstream(file) << ::getpid() << std::endl;
    const auto detector = conelane::make_detector("clc");
    int count = 0;
    for (std::string line; std::getline(std::cin, line);) {
        if (log.is_open()) log << line << std::endl;
        const json input = json::parse(line);
        if (input.value("reset", false)) {
            detector->reset();
            continue;
        }
        const conelane::Scene scene = scene_of(input);
        const json right =
            answer_to(scene, detector->detect(scene, {.time_limit_ms = 60'000.0}), words.at(0));
        const bool at_fault =
            words.size() > 3 && ++count == std::stoi(words[2]) && !std::filesystem::exists(words[3]);
        if (at_fault) {
            std::ofstream(words[3]) << "done\n";
            commit(words[1], right, scene);
        } else {
            say(right.dump());
        }
    }
}
