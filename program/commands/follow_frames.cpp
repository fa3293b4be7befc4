#include "program/commands/follow_frames.hpp"

#include "conelane/invalid_input.hpp"
#include "conelane/planner.hpp"
#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/drivable_lane_file.hpp"
#include "evaluation/formats/file_text.hpp"
#include "evaluation/formats/frame_file.hpp"
#include "evaluation/formats/front_weights_file.hpp"
#include "evaluation/formats/json_node.hpp"
#include "evaluation/formats/plan_file.hpp"
#include "evaluation/input_error.hpp"
#include "program/commands/unanswered.hpp"

#include <cerrno>
#include <iostream>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <system_error>
#include <utility>

namespace conelane::experiments {
namespace {

constexpr const char* kStandardStream = "-";

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
        wanted.detector = options.detector;
        wanted.laps = options.laps;
        wanted.drivable = options.drivable;
        if (!options.weights.empty()) {
            wanted.detector_options.weights = parsed_file(options.weights, [](std::string text) {
                (void)parse_front_weights(text);
                return WeightsBytes{std::move(text)};
            });
        }
        return make_planner(wanted);
    } catch (const InvalidInput& error) {
        throw InvalidInput(option_of(error.key()), reason_of(error));
    }
}

/// Output of plans line by line: a file that appears when it is complete, or standard output at once.
class PlanSink {
  public:
    explicit PlanSink(const FollowOptions& options) : detector_(options.detector) {
        if (options.format != "json") return;  // only the course is written
        if (options.out == kStandardStream) {
            stream_ = &std::cout;
        } else {
            stream_ = &file_.emplace(options.out).stream();
        }
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
        if (file_) file_->commit();
    }
    void report() const { report_errors(errors_); }

  private:
    void write(const std::string& text) {
        if (stream_ == nullptr) return;
        errno = 0;
        *stream_ << text << '\n' << std::flush;
        if (!*stream_)
            throw std::system_error(errno, std::generic_category(), "--out cannot be written to its end");
    }

    std::string detector_;
    std::optional<AtomicFile> file_;
    std::ostream* stream_ = nullptr;
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
    if (options.format == "tum") {
        write_tum_csv(options.out, *course);
    } else {
        write_ft_fsd_csv(options.out, *course);
    }
}

}  // namespace

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
