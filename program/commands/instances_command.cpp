#include "evaluation/progress/progress.hpp"
#include "experiments/instances/instance_library.hpp"
#include "program/commands/commands.hpp"

#include <set>

namespace conelane::program {
namespace {

struct InstancesOptions {
    std::string out;
    std::vector<std::string> sizes{"12", "18", "24", "36", "all"};
    InstanceOptions instances;
    std::vector<std::string> costs{"default"};
    std::vector<std::string> pairings{"near_far"};
};

void run(InstancesOptions& options) {
    InstanceOptions& instances = options.instances;
    instances.nearest = cone_set_sizes("--nearest", options.sizes);
    instances.objectives.clear();
    std::set<std::string> suffixes;
    for (const std::string& costs : options.costs) {
        for (const std::string& pairing : options.pairings) {
            // A file counts by its name without folder and ending.
            InstanceObjective objective{std::filesystem::path(costs).stem().string(),
                                        ParameterSource{costs == "default" ? "" : costs, pairing}.load()};
            if (!suffixes.insert(objective.suffix()).second)
                throw InvalidInput("--params",
                                   fmt::format("two objectives are called '{}'", objective.costs));
            instances.objectives.push_back(std::move(objective));
        }
    }
    InstanceCounts counts;
    {
        const std::vector<InstanceScene> scenes = instance_scenes(instances);
        Progress progress("instances", 2 * scenes.size() * instances.objectives.size());
        counts = write_instances(options.out, scenes, instances, [&] { progress.advance(); });
    }
    const auto [easy, hard, open] = counts.of_class;
    fmt::print(
        "{} programs in {}: {} optima and {} infeasible by both path-pair and CBC, {} proven by one of them "
        "alone, {} open; {} left out, too large or without an edge\n",
        counts.written, options.out, counts.optimal, counts.infeasible,
        counts.written - counts.optimal - counts.infeasible - open, open, counts.too_large);
    fmt::print("classes: {} easy, {} hard, {} open\n", easy, hard, open);
}

}  // namespace

void add_instances_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand(
        "instances",
        "a library of binary programs for other solvers: MPS files of the printed and the tight formulation, "
        "the list conelane.test, conelane.solu with the optima that path-pair and CBC both proved and what "
        "is known of the others, the cone sets, and index.csv with classes and features");
    auto options = std::make_shared<InstancesOptions>();
    InstanceOptions& instances = options->instances;
    instances.tracks = {"generated:straight", "generated:circle", "generated:curvy"};
    instances.scenes.false_positive_rates = {0.1667, 0.5};
    instances.scenes.ranges_m = {30.0};
    instances.scenes.every_m = 120.0;
    command.add_option("--out", options->out, "directory; a library in it is replaced")->required();
    add_tracks_option(command, instances.tracks)->capture_default_str();
    command.add_option("--nearest", options->sizes, "cone-set sizes; `all` for all visible cones")
        ->delimiter(',')
        ->capture_default_str();
    add_scene_options(command, instances.scenes);
    command.add_option("--limit", instances.limit, "scenes at most, of each size, evenly spread")
        ->check(whole_number(1, 1'000'000));
    command
        .add_option("--params", options->costs,
                    "RLD parameters, separated by commas, each an objective: default for (29), n12, context, "
                    "shape, full, learned or a file (JSON)")
        ->delimiter(',')
        ->capture_default_str();
    command.add_option("--pairing", options->pairings, "pairings, each with each objective")
        ->delimiter(',')
        ->check(CLI::IsMember({"near_far", "paper"}))
        ->capture_default_str();
    command
        .add_option("--max-printed-cones", instances.max_printed_cones,
                    "cone sets of more cones have no printed formulation")
        ->check(whole_number(1, 1'000'000));
    add_time_limit_option(command, instances.time_limit_ms);
    command.callback([options] { run(*options); });
}

}  // namespace conelane::program
