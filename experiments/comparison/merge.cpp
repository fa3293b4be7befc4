#include "evaluation/formats/lane_file.hpp"
#include "evaluation/formats/left_out_scenes.hpp"
#include "evaluation/formats/scene_file.hpp"
#include "evaluation/input_error.hpp"
#include "experiments/comparison/comparison.hpp"
#include "experiments/comparison/echo_floor.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <set>
#include <span>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace conelane::experiments {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

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
    ordered_json record;
};

ShardedRun sort_shards(const std::vector<fs::path>& shards) {
    ShardedRun run;
    std::set<std::string> machines;
    for (const fs::path& directory : shards) {
        ordered_json record = ordered_json::parse(read_run_record(directory));
        const fs::path file = directory / "run.json";
        if (!record.contains("shard") || !record["shard"].is_array() || record["shard"].size() != 2) {
            throw InputError(file, 0, "shard", "is missing: the directory is not a shard of a run");
        }
        const auto index = record["shard"][0].get<std::size_t>();
        const auto count = record["shard"][1].get<std::size_t>();
        machines.insert(record.value("machine", ""));
        record.erase("shard");
        record.erase("machine");
        if (run.directories.empty()) {
            run.record = record;
            run.directories.resize(count);
        }
        for (const auto& [key, value] : record.items()) {
            if (!run.record.contains(key) || run.record[key] != value) {
                throw InputError(file, 0, key,
                                 fmt::format("differs from that of {}", shards.front().string()));
            }
        }
        if (record.size() != run.record.size() || count != run.directories.size() || index >= count) {
            throw InputError(file, 0, "shard",
                             fmt::format("is of another run than {}", shards.front().string()));
        }
        if (!run.directories[index].empty()) {
            throw InputError(file, 0, "shard", fmt::format("{}/{} is there twice", index, count));
        }
        run.directories[index] = directory;
    }
    for (std::size_t index = 0; index < run.directories.size(); ++index) {
        if (run.directories[index].empty()) {
            throw InputError("", 0, "shard", fmt::format("{}/{} is missing", index, run.directories.size()));
        }
    }
    run.record["machine"] = fmt::format("{}", fmt::join(machines, "; "));
    return run;
}

}  // namespace

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
        const fs::path scenes_file = shard / "scenes.scenes.jsonl";
        scenes.push_back(read_scenes(scenes_file));
        starts.push_back(lap_starts(scenes.back()));
        set.tracks.merge(read_track_boundaries(track_boundaries_path(scenes_file)));
        conelane::merge(left_out, read_left_out(track_boundaries_path(scenes_file)));
    }
    set.scenes = interleave<AnnotatedScene>(starts, scenes);

    const FolderLock lock = open_run(directory, run.record.dump(), overwrite);
    write_scene_set(directory / "scenes.scenes.jsonl", set, left_out);
    std::vector<std::string> lanes_files;
    for (const ordered_json& detector : run.record.at("methods")) {
        Method method{detector.at("name").get<std::string>()};
        if (detector.contains("nearest")) method.nearest = detector["nearest"].get<std::size_t>();
        lanes_files.push_back(method.lanes_file());
        std::vector<std::vector<LaneRecord>> lanes;
        for (const fs::path& shard : run.directories) lanes.push_back(read_lanes(shard / lanes_files.back()));
        for (std::size_t part = 0; part < lanes.size(); ++part) {
            if (lanes[part].size() != starts[part].back()) {
                throw InputError(run.directories[part] / lanes_files.back(), 0, "",
                                 "does not answer every scene");
            }
        }
        write_lanes(directory / lanes_files.back(), interleave<LaneRecord>(starts, lanes));
    }
    EchoFloor echo;
    for (const fs::path& shard : run.directories) {
        std::ranges::copy(read_echo_floor(shard / kEchoFloorFile), std::back_inserter(echo));
    }
    if (!echo.empty()) write_echo_floor(directory / kEchoFloorFile, echo);
    return score_directory(directory, set, lanes_files, run.record.dump());
}

}  // namespace conelane::experiments
