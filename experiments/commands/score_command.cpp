#include "experiments/commands/commands.hpp"
#include "experiments/comparison/results.hpp"
#include "experiments/files/input_error.hpp"
#include "experiments/files/lane_file.hpp"
#include "experiments/options/shared_options.hpp"
#include "experiments/scenes/scene_file.hpp"
#include "experiments/scoring/score_table.hpp"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace conelane::experiments {
namespace {

struct Options {
    std::string scenes;
    std::vector<std::string> lanes;
    std::string json;
};

void score_all(const Options& options) {
    const std::vector<AnnotatedScene> scenes = read_scenes(options.scenes);
    const std::filesystem::path companion = track_boundaries_path(options.scenes);
    TrackBoundariesByName tracks;
    if (std::filesystem::exists(companion)) tracks = read_track_boundaries(companion);
    std::vector<std::vector<LaneRecord>> records;  // scored records refer to them
    records.reserve(options.lanes.size());
    RecordScorer scorer(scenes, tracks);
    std::vector<ScoredRecord> scored;
    std::map<std::pair<std::string, std::optional<std::size_t>>, std::size_t> file_of;  // by method
    for (std::size_t i = 0; i < options.lanes.size(); ++i) {
        const std::string& file = options.lanes[i];
        records.push_back(read_lanes(file));
        if (records.back().empty()) throw InputError(file, 0, "", "holds no lane");
        for (const LaneRecord& record : records.back()) {
            const std::size_t first = file_of.try_emplace({record.method, record.nearest}, i).first->second;
            if (first == i) continue;
            throw InputError(file, record.line, "method",
                             "lanes of '" + record.method + "' are in " + options.lanes[first] + " too");
        }
        std::ranges::move(scorer.score(records.back(), file), std::back_inserter(scored));
    }
    const std::vector<ScoreRow> rows = summarise(scored);
    if (!options.json.empty()) {
        const nlohmann::ordered_json run{{"scenes", options.scenes}, {"lanes", options.lanes}};
        write_results(options.json, rows, run.dump());
    }
    fmt::print("{}", score_table(rows));
    if (tracks.empty()) fmt::print(stderr, "no {}: divergence is unknown\n", companion.string());
}

}  // namespace

void add_score_command(CLI::App& program) {
    CLI::App& command =
        *program.add_subcommand("score", "every measure of both papers, a table of all methods");
    auto options = std::make_shared<Options>();
    command.add_option("--scenes", options->scenes, "*.scenes.jsonl; *.tracks.json beside it")->required();
    command.add_option("--lanes", options->lanes, "*.lanes.jsonl, one or more")->required();
    add_output_option(command, "--json", options->json, "write the rows as JSON lines too");
    command.callback([options] { score_all(*options); });
}

}  // namespace conelane::experiments
