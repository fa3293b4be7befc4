#include "evaluation/formats/drivable_lane_file.hpp"

#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/json_node.hpp"

#include <utility>

#include <fmt/format.h>

namespace conelane {
namespace {

using nlohmann::ordered_json;

/// Adds `trusted_m` and `inferred` if they are known, `bridged` and `points` to an object.
void put_drivable_lane(ordered_json& json, const DrivableLane& lane) {
    if (lane.trusted_m) json["trusted_m"] = *lane.trusted_m;
    if (lane.left_inferred || lane.right_inferred) json["inferred"] = lane.left_inferred ? "left" : "right";
    ordered_json& bridged = json["bridged"] = ordered_json::array();
    for (const BridgedGap& gap : lane.bridged) {
        bridged.push_back(
            {{"side", gap.on_left ? "left" : "right"}, {"from_s_m", gap.from_s_m}, {"to_s_m", gap.to_s_m}});
    }
    ordered_json& points = json["points"] = ordered_json::array();
    for (const DrivablePoint& point : lane.points) {
        points.push_back({{"s_m", point.s_m},
                          {"x_m", point.position.x()},
                          {"y_m", point.position.y()},
                          {"heading_rad", point.heading_rad},
                          {"curvature_1pm", point.curvature_1pm},
                          {"width_left_m", point.width_left_m},
                          {"width_right_m", point.width_right_m}});
    }
}

ordered_json to_json(const DrivableRecord& record) {
    const DrivableLane& lane = record.lane;
    ordered_json json{{"scene", record.scene},
                      {"method", record.detector},
                      {"status", to_string(record.status)},
                      {"closed", lane.closed},
                      {"length_m", lane.length_m}};
    put_drivable_lane(json, lane);
    return json;
}

template <typename Columns>
void write_csv(const std::filesystem::path& file, const DrivableLane& lane, const char* head,
               const Columns& columns) {
    AtomicFile output(file);
    output.stream() << head << '\n';
    for (const DrivablePoint& point : lane.points) {
        const auto [a, b, c, d] = columns(point);
        output.stream() << fmt::format("{:.6f},{:.6f},{:.6f},{:.6f}\n", a, b, c, d);
    }
    output.commit();
}

}  // namespace

void write_drivable_lanes(const std::filesystem::path& file, std::span<const DrivableRecord> records) {
    AtomicFile output(file);
    for (const DrivableRecord& record : records) output.stream() << to_line(to_json(record)) << '\n';
    output.commit();
}

void write_tum_csv(const std::filesystem::path& file, const DrivableLane& lane) {
    write_csv(file, lane, "# x_m,y_m,w_tr_right_m,w_tr_left_m", [](const DrivablePoint& point) {
        return std::array{point.position.x(), point.position.y(), point.width_right_m, point.width_left_m};
    });
}

void write_ft_fsd_csv(const std::filesystem::path& file, const DrivableLane& lane) {
    write_csv(file, lane, "# s_m,x_m,y_m,curvature_1pm", [](const DrivablePoint& point) {
        return std::array{point.s_m, point.position.x(), point.position.y(), point.curvature_1pm};
    });
}

std::string plan_line(std::size_t frame, double time_s, const Plan& plan) {
    ordered_json json{{"frame", frame},       {"time_s", time_s},  {"state", to_string(plan.state)},
                      {"lap", plan.lap},      {"stop", plan.stop}, {"age_s", plan.age_s},
                      {"safe_m", plan.safe_m}};
    if (!plan.phase.empty()) json["phase"] = plan.phase;
    if (!plan.reason.empty()) json["reason"] = plan.reason;
    if (plan.stop_line_m) json["stop_line_m"] = *plan.stop_line_m;
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
