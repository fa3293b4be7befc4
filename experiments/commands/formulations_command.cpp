#include "experiments/commands/commands.hpp"
#include "experiments/commands/shared_options.hpp"
#include "experiments/files/scene_file.hpp"
#include "experiments/formulation_table.hpp"

#include <memory>
#include <string>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

struct Options {
    std::string scenes;
    std::string out;
    FormulationOptions formulations;
    ParameterSource parameters;
};

void measure(Options& options) {
    options.formulations.parameters = options.parameters.load();
    const std::vector<FormulationRow> rows =
        formulation_rows(read_scenes(options.scenes), options.formulations);
    if (!options.out.empty()) write_formulation_rows(options.out, rows);
    fmt::print("{}", formulation_table(rows));
}

}  // namespace

void add_formulations_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand(
        "formulations", "size, LP gap, nodes and time of both formulations by cone-set size");
    auto options = std::make_shared<Options>();
    FormulationOptions& formulations = options->formulations;
    command.add_option("--scenes", options->scenes, "*.scenes.jsonl")->required();
    command.add_option("--sizes", formulations.sizes, "cones of a scene, the nearest ahead")
        ->delimiter(',')
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command
        .add_option_function<std::size_t>(
            "--limit", [&formulations](std::size_t count) { formulations.limit = count; },
            "scenes of each size at most")
        ->check(CLI::Range(1, 1000000));
    add_time_limit_option(command, formulations.time_limit_ms);
    add_parameter_options(command, options->parameters, "the defaults");
    add_output_option(command, "--out", options->out, "write the rows as JSON lines too");
    command.callback([options] { measure(*options); });
}

}  // namespace conelane::experiments
