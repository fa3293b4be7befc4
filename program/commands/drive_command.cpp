#include "conelane/drivable_lane.hpp"
#include "conelane/invalid_input.hpp"
#include "evaluation/formats/drivable_lane_file.hpp"
#include "evaluation/formats/json_node.hpp"
#include "evaluation/formats/lane_file.hpp"
#include "evaluation/formats/scene_file.hpp"
#include "evaluation/input_error.hpp"
#include "experiments/options/shared_options.hpp"
#include "program/commands/commands.hpp"
#include "program/commands/follow_frames.hpp"
#include "program/commands/unanswered.hpp"

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

struct DriveOptions {
    std::string lanes;
    std::string scenes;
    std::string format = "json";
    std::string out;
    std::optional<std::string> id;
    std::optional<std::string> detector;
    DrivableOptions drivable;
    FollowOptions follow;  ///< the values that the other modes share are copied into it
};

std::vector<LaneRecord> chosen_lanes(const DriveOptions& options) {
    std::vector<LaneRecord> records = read_lanes(options.lanes);
    if (records.empty()) throw InputError(options.lanes, 0, "", "holds no lane");
    std::erase_if(records,
                  [&](const LaneRecord& record) { return options.id && record.scene != *options.id; });
    if (records.empty())
        throw InputError(options.lanes, 0, "--id", "'" + *options.id + "' is not a scene of it");
    std::erase_if(records, [&](const LaneRecord& record) {
        return options.detector && record.detector != *options.detector;
    });
    if (records.empty()) {
        throw InputError(options.lanes, 0, "--method",
                         "'" + *options.detector + "' answers none of the scenes");
    }
    if (options.format == "json" || records.size() == 1) return records;
    const LaneRecord& second = records[1];
    if (second.scene != records[0].scene) {
        throw InputError(options.lanes, second.line, "scene",
                         "is a second scene, but --format " + options.format + " writes one lane: see --id");
    }
    throw InputError(options.lanes, second.line, "method",
                     "is a second answer to scene '" + second.scene + "', but --format " + options.format +
                         " writes one lane: see --method");
}

DrivableRecord drive(const LaneRecord& record, const Scene& scene, const DriveOptions& options) {
    try {
        return {record.scene, record.detector, record.answer.status,
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

void follow(const DriveOptions& options) {
    FollowOptions wanted = options.follow;
    if (options.detector) wanted.detector = *options.detector;
    wanted.format = options.format;
    wanted.out = options.out;
    wanted.drivable = options.drivable;
    follow_frames(wanted);
}

void drive_all(const DriveOptions& options) {
    for (const auto& [name, value] : {std::pair("--lanes", &options.lanes), {"--scenes", &options.scenes}}) {
        if (value->empty()) throw InvalidInput(name, "is required, or --follow");
    }
    if (options.out == "-") throw InvalidInput("--out", "is standard output with --follow only");
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
        throw InputError(options.lanes, only.line, "left",
                         "has no centre line between it and the right boundary");
    }
    if (options.format == "tum") {
        write_tum_csv(options.out, lanes.front().lane);
    } else {
        write_ft_fsd_csv(options.out, lanes.front().lane);
    }
}

}  // namespace

/// The options that only --follow uses.
void add_follow_options(CLI::App& command, FollowOptions& options) {
    CLI::Option* const follow = command.add_option(
        "--follow", options.frames,
        "frames of a run, one plan a line: *.frames.jsonl, a run of ft-fsd (JSON), - for standard input");
    for (const char* const other : {"--lanes", "--scenes", "--id"}) follow->excludes(other);
    command.add_option("--mission", options.mission, "trackdrive, autocross, acceleration, skidpad")
        ->needs(follow)
        ->check(CLI::IsMember({"trackdrive", "autocross", "acceleration", "skidpad"}))
        ->capture_default_str();
    command.add_option("--laps", options.laps, "laps of trackdrive (10) and autocross (1)")
        ->needs(follow)
        ->check(CLI::Range(1, 1'000'000));
    command.add_option("--weights", options.weights, "weights of front or front-warm, see detect")
        ->needs(follow);
    command.add_option("--interval", options.interval_s, "time between frames that have no time [s]")
        ->needs(follow)
        ->check(CLI::Range(0.001, 10.0) & !CLI::IsMember({"nan", "-nan"}, CLI::ignore_case))
        ->capture_default_str();
    add_time_limit_option(command, options.time_limit_ms);
    command.get_option("--time-limit")->needs(follow);
}

void add_drive_command(CLI::App& program) {
    CLI::App& command =
        *program.add_subcommand("drive",
                                "centre lines of lanes, with curvature and widths; with --follow "
                                "the plans of a run, frame by frame");
    auto options = std::make_shared<DriveOptions>();
    command.add_option("--lanes", options->lanes, "*.lanes.jsonl");
    command.add_option("--scenes", options->scenes, "*.scenes.jsonl, the scenes of the lanes");
    command
        .add_option("--format", options->format,
                    "json: a line for each lane; tum: x_m,y_m,w_tr_right_m,w_tr_left_m; "
                    "ftfsd: s_m,x_m,y_m,curvature_1pm; the last two hold one lane, with --follow the course")
        ->check(CLI::IsMember({"json", "tum", "ftfsd"}))
        ->capture_default_str();
    add_output_option(command, "--out", options->out,
                      "the file to write; with --follow - writes each line to standard output at once", true)
        ->required();
    command.add_option("--id", options->id, "only lanes of this scene");
    command.add_option("--method", options->detector,
                       "only lanes of this method; with --follow the detector, front-warm by default");
    command
        .add_option("--step", options->drivable.step_m, "distance from point to point [m], in [0.01, 100]")
        ->check(CLI::Range(0.01, 100.0) & !CLI::IsMember({"nan", "-nan"}, CLI::ignore_case))
        ->capture_default_str();
    add_follow_options(command, options->follow);
    command.callback([options] { options->follow.frames.empty() ? drive_all(*options) : follow(*options); });
}

}  // namespace conelane::experiments
