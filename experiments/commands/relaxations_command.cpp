#include "experiments/commands/commands.hpp"
#include "experiments/commands/shared_options.hpp"
#include "experiments/files/scene_file.hpp"
#include "experiments/relaxation_table.hpp"

#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

struct Options {
    std::string scenes;
    std::string out;
    RelaxationOptions relaxations;
    ParameterSource parameters;
};

void measure(Options& options) {
    options.relaxations.parameters = options.parameters.load();
    const std::vector<RelaxationRow> rows = relaxation_rows(read_scenes(options.scenes), options.relaxations);
    if (!options.out.empty()) write_relaxation_rows(options.out, rows);
    fmt::print("{}", relaxation_table(rows));
}

}  // namespace

void add_relaxations_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand(
        "relaxations", "gap, accuracy and time of the relaxations against the optimum by cone-set size");
    auto options = std::make_shared<Options>();
    RelaxationOptions& relaxations = options->relaxations;
    command.add_option("--scenes", options->scenes, "*.scenes.jsonl")->required();
    command.add_option("--sizes", relaxations.sizes, "cones of a scene, the nearest ahead")
        ->delimiter(',')
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command
        .add_option_function<std::size_t>(
            "--limit", [&relaxations](std::size_t count) { relaxations.limit = count; },
            "scenes of each size at most")
        ->check(CLI::Range(1, 1000000));
    add_time_limit_option(command, relaxations.time_limit_ms);
    add_parameter_options(command, options->parameters, "the defaults");
    add_output_option(command, "--out", options->out, "write the rows as JSON lines too");
    command.callback([options] { measure(*options); });
}

}  // namespace conelane::experiments
