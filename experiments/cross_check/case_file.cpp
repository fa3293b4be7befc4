#include "conelane/lane_graph_problem.hpp"
#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/json_node.hpp"
#include "evaluation/formats/parameter_file.hpp"
#include "evaluation/formats/program_files.hpp"
#include "evaluation/formats/scene_file.hpp"
#include "experiments/cross_check/drawn_case.hpp"
#include "model/lane_graph_model.hpp"

#include <array>

namespace conelane::experiments {
namespace {

namespace fs = std::filesystem;

constexpr std::array kFormulations{Formulation::paper, Formulation::tight};

void write_program(const fs::path& file, const CrossCheckCase& drawn) {
    const LaneGraphProblem problem =
        make_problem(drawn.scene, drawn.parameters, parts(drawn.formulation).extent);
    if (problem.edges.empty()) return;
    const LaneGraphModel model(problem, drawn.formulation);
    AtomicFile output(file);
    write_mps(output.stream(), model.program(), drawn.scene.id);
    output.commit();
}

}  // namespace

fs::path write_case(const fs::path& directory, const StoredCase& stored,
                    std::span<const std::string> findings) {
    const CrossCheckCase& drawn = stored.drawn;
    const std::string& name = drawn.scene.id;
    AnnotatedScene scene;
    scene.scene = drawn.scene;
    write_scenes(directory / (name + ".scenes.jsonl"), std::array{scene});
    write_rld_parameters(directory / (name + ".params.json"), drawn.parameters);
    write_program(directory / (name + ".mps"), drawn);
    nlohmann::ordered_json json{{"case", drawn.number},
                                {"kind", drawn.kind},
                                {"scenes", name + ".scenes.jsonl"},
                                {"params", name + ".params.json"},
                                {"formulation", to_string(drawn.formulation)},
                                {"solvers", stored.solvers},
                                {"time_limit_ms", stored.time_limit_ms},
                                {"tight_limit_ms", drawn.tight_limit_ms},
                                {"findings", findings}};
    fs::path file = directory / (name + ".case.json");
    AtomicFile output(file);
    output.stream() << json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
    output.commit();
    return file;
}

StoredCase read_case(const fs::path& file) {
    StoredCase stored;
    with_json_file(file, [&](const JsonNode& json) {
        CrossCheckCase& drawn = stored.drawn;
        drawn.number = static_cast<std::size_t>(json.member("case").unsigned_integer());
        drawn.kind = json.member("kind").string();
        drawn.formulation = json.member("formulation").one_of(kFormulations);
        stored.time_limit_ms = json.member("time_limit_ms").non_negative_number();
        drawn.tight_limit_ms = json.member("tight_limit_ms").non_negative_number();
        const JsonNode solvers = json.member("solvers");
        for (std::size_t i = 0; i < solvers.array_size(); ++i)
            stored.solvers.push_back(solvers.element(i).string());
        if (stored.solvers.empty()) solvers.fail("must name one");
        drawn.scene = read_scenes(file.parent_path() / json.member("scenes").string()).front().scene;
        drawn.parameters = read_rld_parameters(file.parent_path() / json.member("params").string());
    });
    return stored;
}

}  // namespace conelane::experiments
