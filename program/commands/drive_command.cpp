#include "evaluation/formats/frame_file.hpp"
#include "experiments/report/report.hpp"
#include "program/commands/command_parts.hpp"

#include <iostream>

namespace conelane::program {
namespace {

/// Whatever `drive` writes.
struct DriveOutput {
    std::string format = "json";
    std::string out;
    std::optional<std::string> detector;
    DrivableOptions drivable;
    /// The centre line as a file of the format `tum` or `ftfsd`.
    void write_csv(const DrivableLane& lane) const {
        format == "tum" ? write_tum_csv(out, lane) : write_ft_fsd_csv(out, lane);
    }
};

/// A run of frames answered by a planner.
struct FollowOptions : DriveOutput {  // `out`: "-" for standard output
    std::string frames;               ///< file; "-" for standard input
    std::string mission = "trackdrive";
    std::string weights;  ///< empty: the shipped weights
    std::optional<int> laps;
    double interval_s = 0.1;  ///< between frames without time
    double time_limit_ms = 50.0;
    std::string page;    ///< empty: none
    std::string python;  ///< that makes the page; empty: the first found
};

std::string detector_of(const FollowOptions& options) {
    return options.detector.value_or("front-warm");
}

/// The names of the planner's options on the command line.
std::string option_of(const std::string& key) {
    if (key == "mission" || key == "laps" || key == "weights") return "--" + key;
    if (key == "detector") return "--method";
    if (key == "step_m") return "--step";
    return key;
}

std::unique_ptr<Planner> planner_of(const FollowOptions& options) {
    try {
        PlannerOptions wanted;
        wanted.mission = mission_named(options.mission);
        const bool is_circuit = wanted.mission == Mission::trackdrive || wanted.mission == Mission::autocross;
        if (options.format != "json" && !is_circuit) {
            throw InvalidInput("--format", "is json for " + options.mission +
                                               ": the others hold the closed course of a trackdrive or an "
                                               "autocross");
        }
        wanted.detector = detector_of(options);
        wanted.laps = options.laps;
        wanted.drivable = options.drivable;
        const DetectorRecipe* const recipe = find_recipe(wanted.detector);
        if (!options.weights.empty() && recipe != nullptr) {
            wanted.detector_options.weights =
                read_weights_bytes(options.weights, "'" + wanted.detector + "'", recipe);
        }
        return make_planner(wanted);
    } catch (const InvalidInput& error) {
        throw InvalidInput(option_of(error.key()), reason_of(error));
    }
}

/// The page that plays a run, of its frames and plans.
void write_page(const FollowOptions& options, const std::filesystem::path& plans) {
    const std::filesystem::path made = plans.parent_path() / "page.html";
    call_package([&] {
        run_package("report.replay", {options.frames, plans, made, fmt::format("{}", options.interval_s)},
                    options.python, false);
    });
    put_in_place({{made, options.page}});
}

/// The plans of a run, where they are written, not only the course.
class PlanSink {
  public:
    explicit PlanSink(const FollowOptions& options) : detector_(detector_of(options)) {
        if (options.format == "json") output_.emplace(options.out);
        if (!options.page.empty()) for_page_.emplace((folder_.emplace().path() / "plans.jsonl").string());
    }
    void put(const FrameLine& line, const Plan& plan) {
        write(plan_line(line.number, line.frame->time_s, plan));
        if (plan.answer.status == LaneStatus::error) {
            errors_.add_error(detector_, std::to_string(line.number), plan.answer.message);
        } else {
            errors_.add_answer(detector_);
        }
    }
    void put_refused(const FrameLine& line, const std::string& message) {
        write(refused_frame_line(line.number, message));
        errors_.add_error(detector_, std::to_string(line.number), message);
    }
    void commit(const FollowOptions& options) {
        if (for_page_) {
            for_page_->commit();
            write_page(options, folder_->path() / "plans.jsonl");
        }
        if (output_) output_->commit();
    }
    void report() const { report_errors(errors_); }

  private:
    void write(const std::string& text) {
        if (output_) output_->put(text);
        if (for_page_) for_page_->put(text);
    }

    std::string detector_;
    std::optional<LineOutput> output_;
    std::optional<TemporaryFolder> folder_;
    std::optional<LineOutput> for_page_;
    AnswerErrors errors_;
};

void answer_stream(const FollowOptions& options, Planner& planner, PlanSink& sink) {
    for_each_frame_line(std::cin, options.interval_s, [&](const FrameLine& line) {
        if (line.reset) {
            planner.reset();
        } else if (line.frame) {
            try {
                sink.put(line, planner.update(*line.frame, {.time_limit_ms = options.time_limit_ms}));
            } catch (const InvalidInput& error) {
                sink.put_refused(line, error.what());
            }
        } else {
            sink.put_refused(line, line.fault);
        }
    });
}

void answer_file(const FollowOptions& options, Planner& planner, PlanSink& sink) {
    for (const FrameLine& line : read_frames(options.frames, options.interval_s)) {
        if (line.reset) {
            planner.reset();
            continue;
        }
        try {
            sink.put(line, planner.update(*line.frame, {.time_limit_ms = options.time_limit_ms}));
        } catch (const InvalidInput& error) {
            throw InputError(options.frames, line.number, error.key(), reason_of(error));
        }
    }
}

void write_course(const FollowOptions& options, const Planner& planner) {
    const std::optional<DrivableLane> course = planner.course();
    if (!course) {
        const std::string file = options.frames == kStandardStream ? "standard input" : options.frames;
        throw InputError(file, 0, "", "closes no lap: there is no course to write");
    }
    options.write_csv(*course);
}

/// Writes a line for each frame (`json`), or the closed course after the last frame (`tum`, `ftfsd`). Throws
/// InvalidInput and InputError; an invalid line of a stream gets an answer with its fault.
void follow_frames(const FollowOptions& options) {
    if (options.format != "json" && options.out == kStandardStream) {
        throw InvalidInput("--out", "is a file where --format is " + options.format);
    }
    if (options.frames == kStandardStream && !options.page.empty()) {
        throw InvalidInput("--page", "takes the frames of a file");
    }
    const std::unique_ptr<Planner> planner = planner_of(options);
    PlanSink sink(options);
    if (options.frames == kStandardStream) {
        answer_stream(options, *planner, sink);
    } else {
        answer_file(options, *planner, sink);
    }
    if (options.format != "json") write_course(options, *planner);
    sink.commit(options);
    sink.report();
}

struct DriveOptions : FollowOptions {
    std::string lanes;
    std::string scenes;
    std::optional<std::string> id;
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

void drive_all(const DriveOptions& options) {
    for (const auto& [name, value] : {std::pair("--lanes", &options.lanes), {"--scenes", &options.scenes}}) {
        if (value->empty()) throw InvalidInput(name, "is required, or --follow");
    }
    if (options.out == "-") throw InvalidInput("--out", "is standard output with --follow only");
    const std::vector<LaneRecord> records = chosen_lanes(options);
    const ScenesById scenes(options.scenes);
    std::vector<DrivableRecord> lanes;
    for (const LaneRecord& record : records)
        lanes.push_back(drive(record, scenes.of(record.scene, options.lanes, record.line).scene, options));
    if (options.format == "json") {
        write_drivable_lanes(options.out, lanes);
        report_errors(records);
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
    options.write_csv(lanes.front().lane);
}

/// The options that only --follow uses.
void add_follow_options(CLI::App& command, FollowOptions& options) {
    CLI::Option* const follow = command.add_option(
        "--follow", options.frames,
        "frames of a run, one plan a line: *.frames.jsonl, a run of ft-fsd (JSON), - for standard input");
    for (const char* const other : {"--lanes", "--scenes", "--id"}) follow->excludes(other);
    add_word_option(command, "--mission", options.mission,
                    {"trackdrive", "autocross", "acceleration", "skidpad"},
                    "trackdrive, autocross, acceleration, skidpad")
        ->needs(follow);
    command.add_option("--laps", options.laps, "laps of trackdrive (10) and autocross (1)")
        ->needs(follow)
        ->check(CLI::Range(1, 1'000'000));
    command.add_option("--weights", options.weights, "weights of the method, see detect")->needs(follow);
    add_number_option(command, "--interval", options.interval_s, 0.001, 10.0,
                      "time between frames that have no time [s]")
        ->needs(follow);
    add_output_option(command, "--page", options.page,
                      "PAGE.html, which plays the run: cones, lanes, trust, where there was no lane and why")
        ->needs(follow);
    command.add_option("--python", options.python, "interpreter that makes the page; python3 without it")
        ->needs("--page");
    add_time_limit_option(command, options.time_limit_ms);
    command.get_option("--time-limit")->needs(follow);
}

}  // namespace

void add_drive_command(CLI::App& program) {
    CLI::App& command =
        *program.add_subcommand("drive",
                                "centre lines of lanes, with curvature and widths; with --follow "
                                "the plans of a run, frame by frame");
    auto options = std::make_shared<DriveOptions>();
    command.add_option("--lanes", options->lanes, "*.lanes.jsonl");
    command.add_option("--scenes", options->scenes, "*.scenes.jsonl, the scenes of the lanes");
    add_word_option(command, "--format", options->format, {"json", "tum", "ftfsd"},
                    "json: a line for each lane; tum: x_m,y_m,w_tr_right_m,w_tr_left_m; "
                    "ftfsd: s_m,x_m,y_m,curvature_1pm; the last two hold one lane, with --follow the course");
    add_output_option(command, "--out", options->out,
                      "the file to write; with --follow - writes each line to standard output at once", true)
        ->required();
    command.add_option("--id", options->id, "only lanes of this scene");
    command.add_option("--method", options->detector,
                       "only lanes of this method; with --follow the detector, front-warm by default");
    add_number_option(command, "--step", options->drivable.step_m, 0.01, 100.0,
                      "distance from point to point [m], in [0.01, 100]; with --follow at most 5");
    add_follow_options(command, *options);
    command.callback([options] { options->frames.empty() ? drive_all(*options) : follow_frames(*options); });
}

}  // namespace conelane::program
