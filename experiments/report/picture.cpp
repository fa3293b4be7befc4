#include "experiments/report/picture.hpp"

#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/scene_file.hpp"
#include "evaluation/world/scene_options.hpp"
#include "experiments/report/package.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <nlohmann/json.hpp>

namespace conelane::experiments {
namespace {

using nlohmann::ordered_json;

/// A condition with replaced parts is called NAME+PART; its noise is assumed to be that of NAME.
double noise_of(const std::string& condition) {
    for (const Condition& known : named_conditions()) {
        if (condition == known.name || condition.starts_with(known.name + "+")) return known.noise_sigma_m;
    }
    return 0.0;
}

/// The point of the boundary on one side of a point of the centre line.
ordered_json beside(const DrivablePoint& point, bool on_left) {
    const Point normal(-std::sin(point.heading_rad), std::cos(point.heading_rad));
    const Point at = point.position + (on_left ? point.width_left_m : -point.width_right_m) * normal;
    return ordered_json::array({at.x(), at.y()});
}

/// The drawn parts of a lane besides its cones.
ordered_json overlay(const DrivableLane& lane) {
    ordered_json json = ordered_json::object();
    if (lane.left_inferred || lane.right_inferred) {
        ordered_json& points = json["inferred"] = ordered_json::array();
        for (const DrivablePoint& point : lane.points) points.push_back(beside(point, lane.left_inferred));
    }
    if (lane.trusted_m && !lane.points.empty()) {
        const auto past = std::ranges::find_if(
            lane.points, [&](const DrivablePoint& point) { return point.s_m > *lane.trusted_m; });
        const DrivablePoint& last = past == lane.points.begin() ? *past : *(past - 1);
        json["trusted_end"] = ordered_json::array({beside(last, true), beside(last, false)});
    }
    return json;
}

}  // namespace

void write_picture(const Picture& picture, const std::filesystem::path& file,
                   const std::string& wished_python) {
    require_writable(file);
    const TemporaryFolder folder;
    const std::filesystem::path scene = folder.path() / "one.scenes.jsonl";
    const std::filesystem::path lanes = folder.path() / "one.lanes.jsonl";
    const std::filesystem::path how = folder.path() / "how.json";
    const std::filesystem::path made = folder.path() / ("made" + file.extension().string());
    write_scenes(scene, {&picture.scene, 1});
    write_track_boundaries(track_boundaries_path(scene), picture.tracks);
    std::vector<LaneRecord> records;
    ordered_json overlays = ordered_json::array();
    for (const PicturedLane& lane : picture.lanes) {
        records.push_back(lane.record);
        overlays.push_back(overlay(lane.drivable));
    }
    write_lanes(lanes, records);
    AtomicFile description(how);
    description.stream() << ordered_json{
        {"noise_m", noise_of(picture.scene.condition)},
        {"longest_gap_m", DrivableOptions{}.max_gap_m},
        {"with_given", picture.with_given},
        {"with_truth", picture.with_truth},
        {"title", picture.title},
        {"overlays", overlays}}.dump();
    description.commit();
    run_package("report.plot", {scene, track_boundaries_path(scene), lanes, how, made}, wished_python);
    put_in_place({{made, file}});
}

}  // namespace conelane::experiments
