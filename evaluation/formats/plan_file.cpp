#include "evaluation/formats/plan_file.hpp"

#include "evaluation/formats/drivable_lane_json.hpp"
#include "evaluation/formats/json_node.hpp"

#include <utility>

namespace conelane {

using nlohmann::ordered_json;

std::string plan_line(std::size_t frame, double time_s, const Plan& plan) {
    ordered_json json{{"frame", frame},       {"time_s", time_s},  {"state", to_string(plan.state)},
                      {"lap", plan.lap},      {"stop", plan.stop}, {"age_s", plan.age_s},
                      {"safe_m", plan.safe_m}};
    if (!plan.phase.empty()) json["phase"] = plan.phase;
    ordered_json answer{{"status", to_string(plan.answer.status)}};
    if (plan.answer.stopped_by) answer["stopped_by"] = to_string(*plan.answer.stopped_by);
    if (!plan.answer.message.empty()) answer["message"] = plan.answer.message;
    if (plan.answer.confidence) answer["confidence"] = *plan.answer.confidence;
    json["answer"] = std::move(answer);
    json["length_m"] = plan.lane.length_m;
    put_drivable_lane(json, plan.lane);
    return to_line(json);
}

std::string refused_frame_line(std::size_t frame, const std::string& message) {
    return to_line(ordered_json{{"frame", frame}, {"error", message}});
}

}  // namespace conelane
