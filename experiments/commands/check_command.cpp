#include "experiments/commands/commands.hpp"
#include "experiments/files/input_error.hpp"
#include "experiments/files/solution_file.hpp"
#include "experiments/options/shared_options.hpp"
#include "experiments/scenes/scene_file.hpp"
#include "model/check.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

struct Options {
    std::string scenes;
    std::string solutions;
    ParameterSource parameters;
    std::optional<std::size_t> nearest;
};

/// Everything wrong with a record; nothing where it is right or claims no lane graph.
std::vector<std::string> check_record(const SolutionRecord& record, const Scene& scene,
                                      const RldParameters& parameters) {
    if (record.status != "optimal" && record.status != "feasible") return {};
    std::unordered_map<ConeId, std::size_t> index_of;
    for (std::size_t i = 0; i < scene.cones.size(); ++i) index_of.emplace(scene.cones[i].id, i);
    LaneGraph graph;
    for (const auto& [a, b] : record.edges) {
        for (const ConeId id : {a, b}) {
            if (!index_of.contains(id)) return {fmt::format("cone {} is not in the scene", id)};
        }
        graph.edges.push_back(make_edge(index_of.at(a), index_of.at(b)));
    }
    std::ranges::sort(graph.edges);
    if (!record.objective) return {"there is no objective"};
    return check(scene, parameters, graph, {record.status == "optimal", *record.objective, record.bound})
        .violations;
}

void check_all(const Options& options) {
    const RldParameters parameters = options.parameters.load();
    const std::vector<AnnotatedScene> scenes = read_scenes(options.scenes);
    std::unordered_map<std::string, const Scene*> scene_of;
    for (const AnnotatedScene& scene : scenes) scene_of.emplace(scene.scene.id, &scene.scene);
    const std::vector<SolutionRecord> records = read_solutions(options.solutions);
    std::size_t failed = 0;
    if (records.empty()) throw InputError(options.solutions, 0, "", "holds no solution");
    for (const SolutionRecord& record : records) {
        const auto scene = scene_of.find(record.scene);
        if (scene == scene_of.end()) {
            throw InputError(options.solutions, record.line, "scene",
                             "'" + record.scene + "' is not in the scenes file");
        }
        const Scene seen = options.nearest ? nearest_ahead(*scene->second, *options.nearest) : *scene->second;
        const std::vector<std::string> violations = check_record(record, seen, parameters);
        for (const std::string& violation : violations) fmt::print("{}: {}\n", record.scene, violation);
        if (!violations.empty()) ++failed;
    }
    fmt::print("{} passed, {} failed\n", records.size() - failed, failed);
    if (failed > 0) throw CLI::RuntimeError(1);
}

}  // namespace

void add_check_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand(
        "check", "recomputes solutions independently of all solvers; exit code 1 on a failure");
    auto options = std::make_shared<Options>();
    command.add_option("--scenes", options->scenes, "*.scenes.jsonl")->required();
    command.add_option("--solutions", options->solutions, "*.solutions.jsonl")->required();
    add_parameter_options(command, options->parameters, "the defaults");
    add_nearest_option(command, options->nearest,
                       "as in `solve`: shape costs depend on the cone set, all else does not");
    command.callback([options] { check_all(*options); });
}

}  // namespace conelane::experiments
