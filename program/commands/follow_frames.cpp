#include "program/commands/follow_frames.hpp"

#include "conelane/invalid_input.hpp"
#include "conelane/planner.hpp"
#include "evaluation/formats/drivable_lane_file.hpp"
#include "evaluation/formats/frame_file.hpp"
#include "evaluation/formats/json_node.hpp"
#include "evaluation/formats/plan_file.hpp"
#include "evaluation/input_error.hpp"
#include "program/commands/command_parts.hpp"

#include <iostream>
#include <memory>
#include <optional>
#include <string>

namespace conelane::experiments {
namespace {

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
        if (!options.weights.empty())
            wanted.detector_options.weights = read_front_weights_bytes(options.weights);
        return make_planner(wanted);
    } catch (const InvalidInput& error) {
        throw InvalidInput(option_of(error.key()), reason_of(error));
    }
}

/// The plans of a run, where they are written, not only the course.
class PlanSink {
  public:
    explicit PlanSink(const FollowOptions& options) : detector_(detector_of(options)) {
        if (options.format == "json") output_.emplace(options.out);
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
    void commit() {
        if (output_) output_->commit();
    }
    void report() const { report_errors(errors_); }

  private:
    void write(const std::string& text) {
        if (output_) output_->put(text);
    }

    std::string detector_;
    std::optional<LineOutput> output_;
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

}  // namespace

void DriveOutput::write_csv(const DrivableLane& lane) const {
    format == "tum" ? write_tum_csv(out, lane) : write_ft_fsd_csv(out, lane);
}

void follow_frames(const FollowOptions& options) {
    if (options.format != "json" && options.out == kStandardStream) {
        throw InvalidInput("--out", "is a file where --format is " + options.format);
    }
    const std::unique_ptr<Planner> planner = planner_of(options);
    PlanSink sink(options);
    if (options.frames == kStandardStream) {
        answer_stream(options, *planner, sink);
    } else {
        answer_file(options, *planner, sink);
    }
    if (options.format != "json") write_course(options, *planner);
    sink.commit();
    sink.report();
}

}  // namespace conelane::experiments
