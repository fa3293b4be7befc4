#include "experiments/commands/commands.hpp"
#include "experiments/comparison/runner.hpp"
#include "experiments/files/lane_file.hpp"
#include "experiments/methods.hpp"
#include "experiments/options/shared_options.hpp"
#include "experiments/scenes/scene_file.hpp"

#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

struct Options {
    std::string method;
    std::string scenes;
    std::string out;
    ParameterSource parameters;
    RunOptions run;
};

void detect(Options& options) {
    const Method& method = find_method(options.method);
    options.parameters.apply_to(options.run.method);
    const std::vector<AnnotatedScene> scenes = read_scenes(options.scenes);
    write_lanes(options.out, run(method, scenes, options.run));
}

}  // namespace

void add_methods_command(CLI::App& program) {
    program.add_subcommand("methods", "the detection methods of this build")->callback([] {
        for (const Method& method : methods()) {
            const ConeSet set = cone_set(method, {});
            std::string cones = set.nearest ? fmt::format("{} nearest", *set.nearest) : "all";
            if (set.context) cones += fmt::format(" of {}", *set.context);
            fmt::print("{:<16} cones: {:<16} {}\n", method.name, cones, method.meaning);
        }
    });
}

void add_detect_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand("detect", "lanes of scenes, by any method");
    auto options = std::make_shared<Options>();
    options->run.limits.time_limit_ms = kRealTimeLimit_ms;
    command.add_option("--method", options->method, "see `conelane methods`")->required();
    command.add_option("--scenes", options->scenes, "*.scenes.jsonl")->required();
    add_output_option(command, "--out", options->out, "*.lanes.jsonl")->required();
    add_nearest_option(command, options->run.method.nearest, "cone-set size instead of the method's own");
    add_time_limit_option(command, options->run.limits.time_limit_ms);
    add_threads_option(command, options->run.threads, "more than one disturbs the latencies");
    command.add_flag("--candidates", options->run.limits.keep_candidates, "write every enumerated lane too");
    add_parameter_options(command, options->parameters, "the defaults");
    command.callback([options] { detect(*options); });
}

}  // namespace conelane::experiments
