#include "conelane/invalid_input.hpp"
#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/lane_file.hpp"
#include "evaluation/formats/left_out_scenes.hpp"
#include "evaluation/formats/scene_file.hpp"
#include "evaluation/input_error.hpp"
#include "evaluation/outside/finished_lanes.hpp"
#include "evaluation/outside/point_snapping.hpp"
#include "evaluation/scoring/score_table.hpp"
#include "experiments/comparison/results.hpp"
#include "experiments/comparison/summary.hpp"
#include "experiments/methods/method.hpp"
#include "experiments/options/shared_options.hpp"
#include "program/commands/commands.hpp"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace conelane::experiments {
namespace {

struct ScoreOptions {
    std::string scenes;
    std::vector<std::string> lanes;
    std::vector<std::string> detectors;
    std::string json;
    bool wide = false;
};

/// A lanes file with its records, and the detector from outside if it was named as one.
struct LanesFile {
    std::string file;
    std::optional<OutsideDetector> detector;
    std::vector<LaneRecord> records;
};

std::vector<LanesFile> read_all(const ScoreOptions& options, std::span<const AnnotatedScene> scenes) {
    if (options.lanes.empty() && options.detectors.empty())
        throw InvalidInput("--lanes", "is required, or --methods lanes:NAME=FILE");
    std::unordered_map<std::string, const Scene*> scene_of;
    for (const AnnotatedScene& annotated : scenes) scene_of.emplace(annotated.scene.id, &annotated.scene);
    std::vector<LanesFile> all;
    for (const std::string& file : options.lanes) {
        all.push_back({file, {}, read_lanes(file)});
        if (all.back().records.empty()) throw InputError(file, 0, "", "holds no lane");
        for (LaneRecord& record : all.back().records) {
            const auto scene = scene_of.find(record.scene);
            if (scene != scene_of.end()) snap_to_cones(record, *scene->second);
        }
    }
    for (const std::string& text : split_detectors(options.detectors)) {
        if (!text.starts_with("lanes:"))
            throw InvalidInput("--methods", "'" + text + "' is not of the form lanes:NAME=FILE");
        Method method = parse_method(text);
        std::vector<LaneRecord> records = read_finished_lanes(*method.outside, scenes);
        all.push_back({method.outside->source, std::move(method.outside), std::move(records)});
    }
    return all;
}

void score_all(const ScoreOptions& options) {
    const std::vector<AnnotatedScene> scenes = read_scenes(options.scenes);
    const std::filesystem::path companion = track_boundaries_path(options.scenes);
    TrackBoundariesByName tracks;
    LeftOutScenes left_out;
    if (std::filesystem::exists(companion)) {
        tracks = read_track_boundaries(companion);
        left_out = read_left_out(companion);
    }
    std::vector<LanesFile> files = read_all(options, scenes);
    OutsideDetectors outside;
    RecordScorer scorer(scenes, tracks,
                        [&](const std::string& detector) { return outside.courses_of(detector, false); });
    std::vector<ScoredRecord> scored;
    std::map<std::pair<std::string, std::optional<std::size_t>>, std::size_t> file_of;  // by detector
    for (std::size_t i = 0; i < files.size(); ++i) {
        const auto& [file, detector, records] = files[i];
        if (detector) outside.detectors.push_back(*detector);
        for (const LaneRecord& record : records) {
            const std::size_t first = file_of.try_emplace({record.detector, record.nearest}, i).first->second;
            if (first == i) continue;
            throw InputError(file, record.line, "method",
                             "lanes of '" + record.detector + "' are in " + files[first].file + " too");
        }
        std::ranges::move(scorer.score(records, file), std::back_inserter(scored));
    }
    const std::vector<ScoreRow> rows = summarise(scored);
    if (!options.json.empty()) {
        nlohmann::ordered_json run{{"scenes", options.scenes}, {"lanes", options.lanes}};
        if (!options.detectors.empty()) run["lanes_of_methods"] = options.detectors;
        AtomicFile output(options.json);
        write_results(output.stream(), rows, scored, outside, run.dump());
        output.commit();
    }
    if (options.wide) {
        fmt::print("{}{}{}", score_table(rows), outside_notes(scored, outside), table_note_on(left_out));
    } else {
        fmt::print("{}all measures: conelane score --wide\n",
                   summary(scored, summary_notes(outside, left_out)));
    }
    if (tracks.empty()) fmt::print(stderr, "no {}: divergence is unknown\n", companion.string());
}

}  // namespace

void add_score_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand(
        "score", "usable lanes, latency and failures of methods; every measure of both papers");
    auto options = std::make_shared<ScoreOptions>();
    command.add_option("--scenes", options->scenes, "*.scenes.jsonl; *.tracks.json beside it")->required();
    command.add_option("--lanes", options->lanes, "*.lanes.jsonl, one or more");
    command.add_option("--methods", options->detectors,
                       "lanes:NAME=FILE: answers of another program, scored under that name "
                       "(docs/from-outside.md)");
    command.add_flag("--wide", options->wide,
                     "the table of every measure, with the papers' figures below; some 270 columns");
    add_output_option(command, "--json", options->json, "write the rows as JSON lines too");
    command.callback([options] { score_all(*options); });
}

}  // namespace conelane::experiments
