#include "experiments/commands/commands.hpp"
#include "experiments/commands/shared_options.hpp"
#include "experiments/comparison/backends.hpp"
#include "experiments/files/scene_file.hpp"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

struct Options {
    std::string scenes;
    std::string out;
    BackendOptions backends;
    std::vector<std::string> solvers;
    bool warm_start = false;
    ParameterSource parameters;
};

void measure(Options& options) {
    options.backends.parameters = options.parameters.load();
    for (const Backend& backend : exact_backends()) {
        if (std::ranges::find(options.solvers, backend.solver) == options.solvers.end()) continue;
        options.backends.backends.push_back(backend);
        if (!options.warm_start) continue;
        options.backends.backends.push_back(backend);
        options.backends.backends.back().warm_start = true;
    }
    const std::vector<AnnotatedScene> scenes = read_scenes(options.scenes);
    const std::vector<BackendRow> rows = backend_rows(scenes, options.backends);
    if (!options.out.empty()) write_backend_rows(options.out, rows);
    fmt::print("{}", backend_table(rows));
}

}  // namespace

void add_backends_command(CLI::App& program) {
    CLI::App& command =
        *program.add_subcommand("backends", "every exact solver on the same cone sets: optimum, time, nodes");
    auto options = std::make_shared<Options>();
    command.add_option("--scenes", options->scenes, "*.scenes.jsonl")->required();
    std::vector<std::string> known;
    for (const Backend& backend : exact_backends()) known.push_back(backend.solver);
    options->solvers = known;
    command
        .add_option("--solvers", options->solvers, "exact ones; the formulation is the one each is best on")
        ->delimiter(',')
        ->check(CLI::IsMember(known))
        ->capture_default_str();
    command.add_option("--sizes", options->backends.sizes, "cones of a scene, the nearest ahead")
        ->delimiter(',')
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command.add_flag("--warm-start", options->warm_start,
                     "each also from the lane graph of the scene before, its cones found again by id");
    add_time_limit_option(command, options->backends.time_limit_ms);
    add_parameter_options(command, options->parameters, "the defaults");
    add_output_option(command, "--out", options->out,
                      "write a line per solve too; the page shows DIR/backends.jsonl of its results");
    command.callback([options] { measure(*options); });
}

}  // namespace conelane::experiments
