#include "experiments/comparison/comparison.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/scene_file.hpp"
#include "evaluation/formats/scene_set.hpp"
#include "evaluation/input_error.hpp"
#include "evaluation/outside/point_snapping.hpp"
#include "evaluation/progress/progress.hpp"
#include "experiments/comparison/lane_log.hpp"
#include "experiments/comparison/results.hpp"
#include "experiments/comparison/summary.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

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

/// Takes the laps from the parts in turn: lap k of the whole is the next lap of part k mod count.
template <typename T>
std::vector<T> interleave(std::span<const std::vector<std::size_t>> lap_starts_of_part,
                          std::vector<std::vector<T>>& parts) {
    std::vector<T> whole;
    for (std::size_t lap = 0;; ++lap) {
        const std::size_t part = lap % parts.size();
        const std::size_t lap_of_part = lap / parts.size();
        const std::vector<std::size_t>& starts = lap_starts_of_part[part];
        if (lap_of_part + 1 >= starts.size()) return whole;
        const auto begin = parts[part].begin();
        std::ranges::move(begin + static_cast<std::ptrdiff_t>(starts[lap_of_part]),
                          begin + static_cast<std::ptrdiff_t>(starts[lap_of_part + 1]),
                          std::back_inserter(whole));
    }
}

/// The directories in the order of their shards, and the record of the whole run.
struct ShardedRun {
    std::vector<fs::path> directories;
    RunRecord record;
};

ShardedRun sort_shards(const std::vector<fs::path>& shards) {
    ShardedRun run;
    std::set<std::string> machines;
    for (const fs::path& directory : shards) {
        RunRecord record = read_run_record(directory);
        const auto refuse = [&](const std::string& key, const std::string& reason) {
            throw InputError(directory / "run.json", 0, key, reason);
        };
        const auto [index, count] = std::exchange(record.shard, {});
        if (count < 2) refuse("shard", "is missing: the directory is not a shard of a run");
        machines.insert(std::exchange(record.origin.machine, ""));
        if (run.directories.empty()) {
            run.record = record;
            run.directories.resize(count);
        }
        const std::vector<std::string> differences = run.record.differences(record);
        if (!differences.empty())
            refuse(differences.front(), fmt::format("differs from that of {}", shards.front().string()));
        if (count != run.directories.size() || index >= count)
            refuse("shard", fmt::format("is of another run than {}", shards.front().string()));
        if (!run.directories[index].empty())
            refuse("shard", fmt::format("{}/{} is there twice", index, count));
        run.directories[index] = directory;
    }
    for (std::size_t index = 0; index < run.directories.size(); ++index) {
        if (run.directories[index].empty())
            throw InputError("", 0, "shard", fmt::format("{}/{} is missing", index, run.directories.size()));
    }
    run.record.origin.machine = fmt::format("{}", fmt::join(machines, "; "));
    return run;
}

}  // namespace

ComparisonOutcome score_directory(const fs::path& directory, const SceneSet& set, const RunRecord& record) {
    const RecordScorer scorer(set.scenes, set.tracks);
    std::vector<ScoredMethod> scored;
    AnswerErrors errors;
    for (const MethodRecord& method : record.methods) {
        const fs::path file = directory / method.lanes_file();
        scored.push_back(scorer.score(method, read_lanes(file), file));
        for (const LaneRecord& lane : scored.back().records) add_answer_of(errors, lane);
    }
    const LeftOutScenes left_out = read_left_out(track_boundaries_path(directory / kScenesFile));
    // Earlier tables stay, with the scores that they belong to, until all new files are written.
    AtomicFile scores(directory / "scores.jsonl");
    AtomicFile results(directory / "results.jsonl");
    AtomicFile table(directory / "table.txt");
    write_scores(scores.stream(), scored);
    write_results(results.stream(), scored, record.text());
    table.stream() << wide_table(scored) << table_note_on(left_out);
    commit_together(std::array{&scores, &results, &table});
    return {summary(scored, left_out), errors};
}

ComparisonOutcome compare(const ComparisonOptions& options, const fs::path& directory) {
    const RunRecord record = record_of(options);
    std::set<std::string> lanes_files;
    for (const MethodRecord& method : record.methods) {
        if (lanes_files.insert(method.lanes_file()).second) continue;
        const std::string cones = method.nearest ? " of " + std::to_string(*method.nearest) + " cones" : "";
        throw InvalidInput("method", "'" + method.name + "'" + cones + " is named twice");
    }
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
    for (std::size_t i = 0; i < options.methods.size(); ++i) {
        const Method& method = options.methods[i];
        const fs::path file = directory / record.methods[i].lanes_file();
        const auto lanes = finished.find(method.name);
        if (lanes != finished.end()) {
            write_lanes(file, lanes->second);
        } else {
            answer_scenes(method, set.scenes, options.run, file);
        }
    }
    return score_directory(directory, set, record);
}

ComparisonOutcome merge(const std::vector<fs::path>& shards, const fs::path& directory, bool overwrite) {
    for (const fs::path& shard : shards) {
        std::error_code ignored;
        if (fs::equivalent(shard, directory, ignored)) {
            throw InputError(directory, 0, "",
                             "is one of the shards; the joined run needs another directory");
        }
    }
    const ShardedRun run = sort_shards(shards);
    SceneSet set;
    LeftOutScenes left_out;
    std::vector<std::vector<AnnotatedScene>> scenes;
    std::vector<std::vector<std::size_t>> starts;
    for (const fs::path& shard : run.directories) {
        const fs::path scenes_file = shard / kScenesFile;
        scenes.push_back(read_scenes(scenes_file));
        starts.push_back(lap_starts(scenes.back()));
        set.tracks.merge(read_track_boundaries(track_boundaries_path(scenes_file)));
        conelane::merge(left_out, read_left_out(track_boundaries_path(scenes_file)));
    }
    set.scenes = interleave<AnnotatedScene>(starts, scenes);

    const FolderLock lock = open_run(directory, run.record, overwrite);
    write_scene_set(directory / kScenesFile, set, left_out);
    for (const MethodRecord& method : run.record.methods) {
        std::vector<std::vector<LaneRecord>> lanes;
        for (std::size_t part = 0; part < run.directories.size(); ++part) {
            const fs::path file = run.directories[part] / method.lanes_file();
            lanes.push_back(read_lanes(file));
            if (lanes.back().size() != starts[part].back())
                throw InputError(file, 0, "", "does not answer every scene");
        }
        write_lanes(directory / method.lanes_file(), interleave<LaneRecord>(starts, lanes));
    }
    return score_directory(directory, set, run.record);
}

}  // namespace conelane::experiments
