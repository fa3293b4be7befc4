#include "experiments/comparison/comparison.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/left_out_scenes.hpp"
#include "evaluation/formats/scene_file.hpp"
#include "evaluation/input_error.hpp"
#include "evaluation/outside/finished_lanes.hpp"
#include "experiments/comparison/echo_floor.hpp"
#include "experiments/comparison/lane_log.hpp"
#include "experiments/comparison/results.hpp"
#include "experiments/comparison/summary.hpp"
#include "experiments/progress/progress.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <system_error>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace conelane::experiments {
namespace {

namespace fs = std::filesystem;

constexpr const char* kScenesFile = "scenes.scenes.jsonl";

/// Runs a method on the scenes that its lanes file does not yet answer.
void answer_scenes(const Method& method, std::span<const AnnotatedScene> scenes, const RunOptions& options,
                   const fs::path& file) {
    if (fs::exists(file)) return;
    LaneLog log(file);
    const std::vector<std::size_t> starts = lap_starts(scenes);
    // An incomplete lap is driven again, because a detector with state must see it from its beginning.
    const std::size_t stored = std::min(log.stored(), scenes.size());
    const std::size_t done = *std::prev(std::ranges::upper_bound(starts, stored));
    log.keep(done);
    run(method, scenes.subspan(done), options, [&](std::span<const LaneRecord> lap) { log.append(lap); });
    log.finish();
}

/// The answers of the lanes files among the methods, by name. They are read before anything is written, so
/// that an invalid file cannot stop a run that has begun.
std::map<std::string, std::vector<LaneRecord>> finished_lanes(const ComparisonOptions& options,
                                                              std::span<const AnnotatedScene> scenes,
                                                              const fs::path& directory) {
    std::map<std::string, std::vector<LaneRecord>> lanes;
    for (const Method& method : options.methods) {
        if (!method.is_lanes_file()) continue;
        const fs::path file = method.outside->source;
        std::error_code ignored;
        if (fs::equivalent(fs::absolute(file).parent_path(), directory, ignored))
            throw InputError(file, 0, "", "is in the directory of the results, whose files would replace it");
        lanes.emplace(method.name, read_finished_lanes(*method.outside, scenes));
    }
    return lanes;
}

AnswerErrors errors_among(const std::vector<std::vector<LaneRecord>>& files) {
    AnswerErrors errors;
    for (const std::vector<LaneRecord>& records : files) {
        for (const LaneRecord& record : records) add_answer_of(errors, record);
    }
    return errors;
}

}  // namespace

ComparisonOutcome score_directory(const fs::path& directory, const SceneSet& set,
                                  const std::vector<std::string>& lanes_files,
                                  const std::string& run_record) {
    std::vector<std::vector<LaneRecord>> records;  // scored records refer to them
    records.reserve(lanes_files.size());
    const OutsideDetectors outside{outside_detectors_of_record(run_record),
                                   read_echo_floor(directory / kEchoFloorFile)};
    const bool is_cross_validated = nlohmann::json::parse(run_record).contains("cross_validation");
    RecordScorer scorer(set.scenes, set.tracks, [&](const std::string& detector) {
        return outside.courses_of(detector, is_cross_validated);
    });
    std::vector<ScoredRecord> scored;
    for (const std::string& name : lanes_files) {
        records.push_back(read_lanes(directory / name));
        std::ranges::move(scorer.score(records.back(), directory / name), std::back_inserter(scored));
    }
    const std::vector<ScoreRow> rows = summarise(scored);
    const LeftOutScenes left_out = read_left_out(track_boundaries_path(directory / kScenesFile));
    const std::string table = score_table(rows) + outside_notes(scored, outside) + table_note_on(left_out);
    // Earlier tables stay, with the scores that they belong to, until all new files are written.
    AtomicFile scores(directory / "scores.jsonl");
    AtomicFile results(directory / "results.jsonl");
    AtomicFile table_text(directory / "table.txt");
    write_scores(scores.stream(), scored);
    write_results(results.stream(), rows, scored, outside, run_record);
    table_text.stream() << table;
    commit_together(std::array{&scores, &results, &table_text});
    return {summary(scored, summary_notes(outside, left_out)), errors_among(records)};
}

ComparisonOutcome compare(const ComparisonOptions& options, const fs::path& directory) {
    std::set<std::string> lanes_files_seen;
    bool any_program = false;
    for (const Method& method : options.methods) {
        any_program = any_program || method.programs;
        if (lanes_files_seen.insert(method.lanes_file()).second) continue;
        const std::string cones = method.nearest ? " of " + std::to_string(*method.nearest) + " cones" : "";
        throw InvalidInput("method", "'" + method.name + "'" + cones + " is named twice");
    }
    const std::string record = run_record(options);
    LeftOutScenes left_out;
    std::optional<Progress> progress;
    const SceneSet set = make_scene_set(options.tracks, options.scenes, options.shard, left_out,
                                        [&](std::size_t, std::size_t total) {
                                            if (progress)
                                                progress->advance();
                                            else
                                                progress.emplace("scenes", total);
                                        });
    progress.reset();
    if (set.scenes.empty())
        throw InputError("", 0, "--shard", "has no scene: there are fewer laps than shards");
    const auto finished = finished_lanes(options, set.scenes, directory);

    const FolderLock lock = open_run(directory, record, options.overwrite);
    write_scene_set(directory / kScenesFile, set, left_out);
    if (!left_out.empty()) fmt::print(stderr, "conelane: {}\n", note_on(left_out));
    if (options.prepare) options.prepare();
    std::vector<std::string> lanes_files;
    for (const Method& method : options.methods) {
        lanes_files.push_back(method.lanes_file());
        const fs::path file = directory / lanes_files.back();
        const auto lanes = finished.find(method.name);
        if (lanes != finished.end()) {
            write_lanes(file, lanes->second);
        } else {
            answer_scenes(method, set.scenes, options.run, file);
        }
    }
    const fs::path echo_file = directory / kEchoFloorFile;
    if (any_program && !fs::exists(echo_file)) write_echo_floor(echo_file, measure_echo_floor(set.scenes));
    return score_directory(directory, set, lanes_files, record);
}

}  // namespace conelane::experiments
