#include "conelane/drivable_lane.hpp"
#include "conelane/invalid_input.hpp"
#include "evaluation/files/drivable_lane_file.hpp"
#include "evaluation/files/input_error.hpp"
#include "evaluation/files/json_node.hpp"
#include "evaluation/files/lane_file.hpp"
#include "evaluation/scenes/scene_file.hpp"
#include "experiments/options/shared_options.hpp"
#include "program/commands/commands.hpp"
#include "program/commands/unanswered.hpp"

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

struct Options {
    std::string lanes;
    std::string scenes;
    std::string format = "json";
    std::string out;
    std::optional<std::string> id;
    std::optional<std::string> method;
    DrivableOptions drivable;
};

std::vector<LaneRecord> chosen_lanes(const Options& options) {
    std::vector<LaneRecord> records = read_lanes(options.lanes);
    if (records.empty()) throw InputError(options.lanes, 0, "", "holds no lane");
    std::erase_if(records,
                  [&](const LaneRecord& record) { return options.id && record.scene != *options.id; });
    if (records.empty())
        throw InputError(options.lanes, 0, "--id", "'" + *options.id + "' is no scene of it");
    std::erase_if(records, [&](const LaneRecord& record) {
        return options.method && record.method != *options.method;
    });
    if (records.empty()) {
        throw InputError(options.lanes, 0, "--method",
                         "'" + *options.method + "' answers none of the scenes");
    }
    if (options.format == "json" || records.size() == 1) return records;
    const LaneRecord& second = records[1];
    if (second.scene != records[0].scene) {
        throw InputError(
            options.lanes, second.line, "scene",
            "is a second one, of which --format " + options.format + " needs --id to choose one");
    }
    throw InputError(options.lanes, second.line, "method",
                     "is a second answer to scene '" + second.scene + "', of which --format " +
                         options.format + " holds one: see --method");
}

DrivableRecord drive(const LaneRecord& record, const Scene& scene, const Options& options) {
    try {
        return {record.scene, record.method, record.answer.status,
                drivable(record.answer, scene, options.drivable)};
    } catch (const InvalidInput& error) {
        throw InputError(options.lanes, record.line, error.key(), reason_of(error));
    }
}

AnswerErrors errors_among(const std::vector<LaneRecord>& records) {
    AnswerErrors errors;
    for (const LaneRecord& record : records) add_answer_of(errors, record);
    return errors;
}

void drive_all(const Options& options) {
    const std::vector<LaneRecord> records = chosen_lanes(options);
    const std::vector<AnnotatedScene> scenes = read_scenes(options.scenes);
    std::unordered_map<std::string_view, const Scene*> scene_of;
    for (const AnnotatedScene& scene : scenes) scene_of.emplace(scene.scene.id, &scene.scene);
    std::vector<DrivableRecord> lanes;
    for (const LaneRecord& record : records) {
        const auto found = scene_of.find(record.scene);
        if (found == scene_of.end()) {
            throw InputError(options.lanes, record.line, "scene",
                             "'" + record.scene + "' is not in " + options.scenes);
        }
        lanes.push_back(drive(record, *found->second, options));
    }
    if (options.format == "json") {
        write_drivable_lanes(options.out, lanes);
        report_errors(errors_among(records));
        return;
    }
    const LaneRecord& only = records.front();
    if (only.answer.status != LaneStatus::found) {
        throw InputError(options.lanes, only.line, "status",
                         "is " + std::string(to_string(only.answer.status)) + ": there is no lane to drive");
    }
    if (lanes.front().lane.points.empty()) {
        throw InputError(options.lanes, only.line, "left", "bounds no centre line with the right boundary");
    }
    if (options.format == "tum") {
        write_tum_csv(options.out, lanes.front().lane);
    } else {
        write_ft_fsd_csv(options.out, lanes.front().lane);
    }
}

}  // namespace

void add_drive_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand("drive", "centre lines of lanes, with curvature and widths");
    auto options = std::make_shared<Options>();
    command.add_option("--lanes", options->lanes, "*.lanes.jsonl")->required();
    command.add_option("--scenes", options->scenes, "*.scenes.jsonl, the scenes of the lanes")->required();
    command
        .add_option("--format", options->format,
                    "json: a line for each lane; tum: x_m,y_m,w_tr_right_m,w_tr_left_m; "
                    "ftfsd: s_m,x_m,y_m,curvature_1pm; the last two hold one lane")
        ->check(CLI::IsMember({"json", "tum", "ftfsd"}))
        ->capture_default_str();
    add_output_option(command, "--out", options->out, "the file to write")->required();
    command.add_option("--id", options->id, "only lanes of this scene");
    command.add_option("--method", options->method, "only lanes of this method");
    command.add_option("--step", options->drivable.step_m, "from point to point [m], in [0.01, 100]")
        ->check(CLI::Range(0.01, 100.0) & !CLI::IsMember({"nan", "-nan"}, CLI::ignore_case))
        ->capture_default_str();
    command.callback([options] { drive_all(*options); });
}

}  // namespace conelane::experiments
