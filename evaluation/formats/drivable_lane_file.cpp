#include "evaluation/formats/drivable_lane_file.hpp"

#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/drivable_lane_json.hpp"
#include "evaluation/formats/json_node.hpp"

#include <utility>

#include <fmt/format.h>

namespace conelane {
namespace {

using nlohmann::ordered_json;

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

}  // namespace

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

void write_drivable_lanes(const std::filesystem::path& file, std::span<const DrivableRecord> records) {
    AtomicFile output(file);
    for (const DrivableRecord& record : records) output.stream() << to_line(to_json(record)) << '\n';
    output.commit();
}

void write_tum_csv(const std::filesystem::path& file, const DrivableLane& lane) {
    AtomicFile output(file);
    output.stream() << "# x_m,y_m,w_tr_right_m,w_tr_left_m\n";
    for (const DrivablePoint& point : lane.points) {
        output.stream() << fmt::format("{:.6f},{:.6f},{:.6f},{:.6f}\n", point.position.x(),
                                       point.position.y(), point.width_right_m, point.width_left_m);
    }
    output.commit();
}

void write_ft_fsd_csv(const std::filesystem::path& file, const DrivableLane& lane) {
    AtomicFile output(file);
    output.stream() << "# s_m,x_m,y_m,curvature_1pm\n";
    for (const DrivablePoint& point : lane.points) {
        output.stream() << fmt::format("{:.6f},{:.6f},{:.6f},{:.6f}\n", point.s_m, point.position.x(),
                                       point.position.y(), point.curvature_1pm);
    }
    output.commit();
}

}  // namespace conelane
