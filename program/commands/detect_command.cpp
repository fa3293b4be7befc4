#include "program/commands/command_parts.hpp"
#include "solvers/registry.hpp"

#include <iostream>

namespace conelane::program {
namespace {

struct DetectOptions {
    std::string method;
    std::string scenes;
    std::string out;
    std::string weights;  ///< empty: the shipped ones
    ParameterSource parameters;
    std::optional<std::size_t> nearest;
    RunOptions run;
};

/// The method, and into the options what it takes of them.
Method method_of(DetectOptions& options) {
    options.parameters.apply_to(options.run.detector);
    Method method = parse_method(options.method);
    if (method.is_lanes_file())
        throw InvalidInput("--method",
                           "'" + options.method + "' is a finished lanes file: there is nothing to detect");
    method.nearest = options.nearest;
    const std::string who = (method.outside ? "the program '" : "'") + method.name + "'";
    if (!method.is_rld()) options.parameters.require_not_given(who + " has");
    if (options.weights.empty()) return method;
    options.run.detector.weights = read_weights_bytes(options.weights, who, method.recipe);
    return method;
}

/// One scene after another. Nothing is answered untimed first, because no scene is known in advance.
void detect_streamed(const Method& method, const DetectOptions& options) {
    if (options.run.threads > 1) throw InvalidInput("--threads", "a stream is answered by one thread");
    const std::unique_ptr<TimedDetector> timed = method.maker(options.run)("");
    LineOutput output(options.out);
    AnswerErrors errors;
    const auto put = [&](const LaneRecord& record) {
        output.put(lane_line(record));
        add_answer_of(errors, record);
    };
    if (options.scenes == kStandardStream) {
        for_each_scene_line(std::cin, [&](const SceneLine& line) {
            if (line.reset) {
                timed->reset();
            } else if (line.scene) {
                put(timed->answer(line.scene->scene));
            } else {
                LaneRecord wrong{std::to_string(line.number), method.name, {}, 0.0, {}};
                wrong.answer.status = LaneStatus::error;
                wrong.answer.message = line.fault;
                put(wrong);
            }
        });
    } else {
        const std::vector<AnnotatedScene> scenes = read_scenes(options.scenes);
        for (std::size_t i = 0; i < scenes.size(); ++i) {
            if (i > 0 && !same_lap(scenes[i - 1], scenes[i])) timed->reset();
            put(timed->answer(scenes[i].scene));
        }
    }
    output.commit();
    report_errors(errors);
}

void detect(DetectOptions& options) {
    const Method method = method_of(options);
    if (options.scenes == kStandardStream || options.out == kStandardStream) {
        detect_streamed(method, options);
        return;
    }
    const std::vector<AnnotatedScene> scenes = read_scenes(options.scenes);
    const std::vector<LaneRecord> lanes = run(method, scenes, options.run);
    write_lanes(options.out, lanes);
    report_errors(lanes);
}

void list_solvers() {
    for (const RldSolverEntry& solver : rld_solvers()) {
        fmt::print("{:<16} {:<28} {}\n", solver.name,
                   solver.has(SolverTrait::uses_formulation) ? "formulations: tight, paper" : "",
                   solver.description);
    }
}

}  // namespace

void add_methods_command(CLI::App& program) {
    CLI::App& command =
        *program.add_subcommand("methods", "the detection methods of this build, or its RLD solvers");
    auto solvers = std::make_shared<bool>(false);
    command.add_flag("--solvers", *solvers, "the RLD solvers instead");
    command.callback([solvers] {
        if (*solvers) return list_solvers();
        for (const Method& method : known_methods()) {
            const ConeSet set = cone_set(*method.recipe, {});
            std::string cones = set.nearest ? fmt::format("{} nearest", *set.nearest) : "all";
            if (set.context) cones += fmt::format(" of {}", *set.context);
            fmt::print("{:<16} cones: {:<16} {}\n", method.name, cones, method.recipe->description);
        }
    });
}

void add_detect_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand(
        "detect",
        "lanes of scenes, by any method. With `--scenes - --out -` it is a stream: each scene line is "
        "answered at once by a lane line. A line {\"reset\": true} says that another lap begins; an invalid "
        "line gets an answer of status error");
    auto options = std::make_shared<DetectOptions>();
    options->run.limits.time_limit_ms = kRealTimeLimit_ms;
    command
        .add_option("--method", options->method,
                    "see `conelane methods`, or exec:NAME=COMMAND for any program (docs/from-outside.md)")
        ->required();
    command.add_option("--scenes", options->scenes, "*.scenes.jsonl; - reads standard input line by line")
        ->required();
    add_output_option(command, "--out", options->out,
                      "*.lanes.jsonl; - writes each line to standard output at once", true)
        ->required();
    add_nearest_option(command, options->nearest, "cone-set size instead of the method's own");
    add_time_limit_option(command, options->run.limits.time_limit_ms);
    add_threads_option(command, options->run.threads,
                       "number of threads; with more than one, latencies are disturbed");
    command.add_flag("--candidates", options->run.limits.keep_candidates, "write every enumerated lane too");
    add_parameter_options(command, options->parameters, "the defaults");
    command.add_option("--weights", options->weights,
                       "weights of front, front-warm or rld-strip: a file that `conelane train` wrote");
    command.callback([options] { detect(*options); });
}

}  // namespace conelane::program
