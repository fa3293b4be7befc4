#include "evaluation/files/atomic_file.hpp"
#include "evaluation/files/json_node.hpp"
#include "evaluation/files/provenance.hpp"
#include "evaluation/scenes/scene_options_json.hpp"
#include "evaluation/scenes/scene_set.hpp"
#include "experiments/options/shared_options.hpp"
#include "experiments/options/whole_number.hpp"
#include "experiments/progress/progress.hpp"
#include "experiments/tuning/detector_tuning.hpp"
#include "program/commands/commands.hpp"

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

using nlohmann::ordered_json;

struct TuneMethodOptions {
    std::string detector;
    std::vector<std::string> tracks;
    SceneOptions scenes;
    DetectorTuningOptions tuning;
    std::string out;
};

ordered_json describe(const DetectorFigure& figure) {
    return {{"scenes", figure.scenes}, {"usable", figure.usable}, {"iou", figure.iou}};
}

ordered_json record_of(const TuneMethodOptions& options, const TunedDetector& tuned) {
    const Provenance origin = provenance();
    ordered_json json{{"method", options.detector},
                      {"commit", origin.commit},
                      {"compiler", origin.compiler},
                      {"machine", origin.machine},
                      {"tracks", options.tracks}};
    json.update(scene_options_json(options.scenes));
    json["evaluations"] = options.tuning.evaluations;
    json["figure_of_start"] = describe(tuned.figure_of_start);
    json["figure"] = describe(tuned.figure);
    return json;
}

void run(TuneMethodOptions& options) {
    const TunableDetector& detector = find_tunable_detector(options.detector);
    options.scenes.threads = options.tuning.threads;
    options.tuning.seed = options.scenes.seed;
    const SceneSet set = make_scene_set(options.tracks, options.scenes);
    TunedDetector tuned;
    {
        Progress progress("tune " + options.detector, options.tuning.evaluations);
        tuned = tune_detector(detector, set, options.tuning, [&] { progress.advance(); });
    }
    AtomicFile record(std::filesystem::path(options.out).replace_extension(".record.json"));
    record.stream() << record_of(options, tuned).dump(2) << '\n';
    AtomicFile parameters(options.out);
    parameters.stream() << to_json_text(detector, tuned.values);
    commit_together(std::array{&record, &parameters});
    const auto text = [](const DetectorFigure& figure) {
        return fmt::format("{:.1f} % usable, IoU {:.1f} %", 100.0 * figure.usable, 100.0 * figure.iou);
    };
    fmt::print("{} on {} scenes: {} before, {} after\n", options.detector, tuned.figure.scenes,
               text(tuned.figure_of_start), text(tuned.figure));
}

}  // namespace

void add_tune_method_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand(
        "tune-method",
        "finds the parameters of delaunay-beam or astar-lane whose lanes are usable most often on given "
        "tracks");
    auto options = std::make_shared<TuneMethodOptions>();
    options->scenes.false_positive_rates = {0.0, 0.1, 0.3, 0.5};
    options->scenes.ranges_m = {30.0};
    options->scenes.every_m = 8.8;
    command.add_option("--method", options->detector, "delaunay-beam or astar-lane")->required();
    command
        .add_option("--tracks", options->tracks, "generated:NAME, fsd:DIR[:1,2], pacsim:FILE or eufs:FILE")
        ->required();
    add_scene_options(command, options->scenes);
    command
        .add_option("--evaluations", options->tuning.evaluations,
                    "number of parameter sets that the search evaluates")
        ->check(whole_number(1, 1'000'000))
        ->capture_default_str();
    add_threads_option(command, options->tuning.threads, "scenes answered at a time");
    add_output_option(command, "--out", options->out, "P.json; its record goes to P.record.json")->required();
    command.callback([options] { run(*options); });
}

}  // namespace conelane::experiments
