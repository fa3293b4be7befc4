#include "experiments/comparison/comparison.hpp"

#include "conelane/invalid_input.hpp"
#include "experiments/comparison/lane_log.hpp"
#include "experiments/comparison/results.hpp"
#include "experiments/files/atomic_file.hpp"
#include "experiments/files/input_error.hpp"

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

namespace conelane::experiments {
namespace {

namespace fs = std::filesystem;

constexpr const char* kScenesFile = "scenes.scenes.jsonl";

/// Runs an entrant on the scenes that its lanes file does not answer yet.
void answer_scenes(const Entrant& entrant, std::span<const AnnotatedScene> scenes, RunOptions options,
                   const fs::path& file) {
    if (fs::exists(file)) return;
    options.method.nearest = entrant.nearest;
    LaneLog log(file);
    const std::vector<std::size_t> starts = lap_starts(scenes);
    // A lap that was broken off is driven again: a detector with state must see it from its beginning.
    const std::size_t stored = std::min(log.stored(), scenes.size());
    const std::size_t done = *std::prev(std::ranges::upper_bound(starts, stored));
    log.keep(done);
    run(find_method(entrant.method), scenes.subspan(done), options,
        [&](std::span<const LaneRecord> lap) { log.append(lap); });
    log.finish();
}

void write_text(const fs::path& file, const std::string& text) {
    AtomicFile output(file);
    output.stream() << text;
    output.commit();
}

}  // namespace

std::vector<ScoreRow> score_directory(const fs::path& directory, const SceneSet& set,
                                      const std::vector<std::string>& lanes_files,
                                      const std::string& run_record) {
    std::vector<std::vector<LaneRecord>> records;  // scored records refer to them
    records.reserve(lanes_files.size());
    RecordScorer scorer(set.scenes, set.tracks);
    std::vector<ScoredRecord> scored;
    for (const std::string& name : lanes_files) {
        records.push_back(read_lanes(directory / name));
        std::ranges::move(scorer.score(records.back(), directory / name),
                          std::back_inserter(scored));
    }
    std::vector<ScoreRow> rows = summarise(scored);
    write_scores(directory / "scores.jsonl", scored);
    write_results(directory / "results.jsonl", rows, run_record);
    write_text(directory / "table.txt", score_table(rows));
    return rows;
}

std::vector<ScoreRow> compare(const ComparisonOptions& options, const fs::path& directory) {
    std::set<std::string> lanes_of_entrants;
    for (const Entrant& entrant : options.entrants) {
        (void)find_method(entrant.method);
        if (lanes_of_entrants.insert(entrant.lanes_file()).second) continue;
        const std::string cones = entrant.nearest ? " of " + std::to_string(*entrant.nearest) + " cones" : "";
        throw InvalidInput("method", "'" + entrant.method + "'" + cones + " is named twice");
    }
    const SceneSet set = make_scene_set(options.tracks, options.scenes, options.shard);
    if (set.scenes.empty())
        throw InputError("", 0, "--shard", "has no scene: there are fewer laps than shards");

    const std::string record = run_record(options);
    const FolderLock lock = open_run(directory, record, options.overwrite);
    write_scene_set(directory / kScenesFile, set);
    std::vector<std::string> lanes_files;
    for (const Entrant& entrant : options.entrants) {
        lanes_files.push_back(entrant.lanes_file());
        answer_scenes(entrant, set.scenes, options.run, directory / lanes_files.back());
    }
    return score_directory(directory, set, lanes_files, record);
}

}  // namespace conelane::experiments
