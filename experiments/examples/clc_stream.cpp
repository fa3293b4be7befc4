// An example of a detector from outside in C++: conelane's own `clc` behind the line protocol. For `conelane
// compare --methods "exec:clc-stream=./clc_stream"`.
#include <iostream>

#include <conelane/detectors.hpp>
#include <nlohmann/json.hpp>

conelane::Point position(const nlohmann::json& json) {
    return {json.at("x").get<double>(), json.at("y").get<double>()};
}

int main() {
    const auto detector = conelane::make_detector("clc");
    for (std::string line; std::getline(std::cin, line);) {
        const auto input = nlohmann::json::parse(line);
        if (input.value("reset", false)) {  // another lap begins
            detector->reset();
            continue;
        }
        conelane::Scene scene{input.at("id"), {position(input.at("pose")), input.at("pose").at("yaw")}, {}};
        for (const auto& cone : input.at("cones")) scene.cones.push_back({cone.at("id"), position(cone)});
        const conelane::LaneAnswer answer = detector->detect(scene, {.time_limit_ms = 400.0});
        const nlohmann::json output{{"scene", scene.id},          {"status", to_string(answer.status)},
                                    {"message", answer.message},  {"left", answer.lane.left},
                                    {"right", answer.lane.right}, {"closed", answer.lane.closed}};
        std::cout << output << std::endl;  // a line, flushed
    }
}
