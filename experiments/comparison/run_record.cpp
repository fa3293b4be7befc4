#include "experiments/comparison/run_record.hpp"

#include "experiments/files/atomic_file.hpp"
#include "experiments/files/input_error.hpp"
#include "experiments/provenance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace conelane::experiments {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRunFile = "run.json";

bool is_of_a_run(const fs::path& file) {
    const std::string name = file.filename().string();
    constexpr std::array<std::string_view, 6> kNames{
        kRunFile, "results.jsonl", "scores.jsonl", "table.txt", "scenes.scenes.jsonl", "scenes.tracks.json"};
    return name.ends_with(".lanes.jsonl") || name.ends_with(".lanes.jsonl.part") ||
           std::ranges::find(kNames, name) != kNames.end();
}

std::vector<fs::path> files_of_a_run(const fs::path& directory) {
    std::vector<fs::path> files;
    for (const fs::directory_entry& entry : fs::directory_iterator(directory)) {
        if (is_of_a_run(entry.path())) files.push_back(entry.path());
    }
    std::ranges::sort(files);
    return files;
}

/// Keys under which two records say different things; "its record" where the text differs otherwise.
std::vector<std::string> differing_keys(const std::string& stored, const std::string& wanted) {
    const nlohmann::json a = nlohmann::json::parse(stored);
    const nlohmann::json b = nlohmann::json::parse(wanted);
    std::set<std::string> keys;
    for (const auto& [first, second] : {std::pair{&a, &b}, std::pair{&b, &a}}) {
        for (const auto& [key, value] : first->items()) {
            if (!second->contains(key) || (*second)[key] != value) keys.insert(key);
        }
    }
    if (keys.empty()) keys.insert("its record");
    return {keys.begin(), keys.end()};
}

/// FNV-1a of the file of this program; empty where it cannot be read.
std::string program_hash() {
    std::ifstream program("/proc/self/exe", std::ios::binary);
    if (!program) return "";
    std::uint64_t hash = 14695981039346656037U;
    std::array<char, 1U << 16U> block{};
    while (program.read(block.data(), block.size()), program.gcount() > 0) {
        for (std::streamsize i = 0; i < program.gcount(); ++i) {
            hash = (hash ^ static_cast<unsigned char>(block[static_cast<std::size_t>(i)])) * 1099511628211U;
        }
    }
    return fmt::format("{:016x}", hash);
}

nlohmann::ordered_json to_json(const RldParameters& parameters) {
    nlohmann::ordered_json json;
    for (const RldParameterField& field : rld_parameter_fields()) {
        json[std::string(field.key)] = parameters.*field.value;
    }
    json["pairing"] = to_string(parameters.pairing);
    for (const RldParameterField& field : rld_extra_fields()) {
        json[std::string(field.key)] = parameters.*field.value;
    }
    json["use_confidence"] = parameters.use_confidence;
    json["forbid_crossing"] = parameters.forbid_crossing;
    return json;
}

}  // namespace

std::string Entrant::lanes_file() const {
    return nearest ? fmt::format("{}.n{:03}.lanes.jsonl", method, *nearest) : method + ".lanes.jsonl";
}

std::string run_record(const ComparisonOptions& options) {
    const Provenance origin = provenance();
    nlohmann::ordered_json methods = nlohmann::ordered_json::array();
    for (const Entrant& entrant : options.entrants) {
        nlohmann::ordered_json json{{"name", entrant.method}};
        if (entrant.nearest) json["nearest"] = *entrant.nearest;
        const Method& method = find_method(entrant.method);
        if (method.is_rld()) json["rld_parameters"] = to_json(rld_parameters(method, options.run.method));
        methods.push_back(json);
    }
    const SceneOptions& scenes = options.scenes;
    nlohmann::ordered_json record{
        {"commit", origin.commit},
        {"compiler", origin.compiler},
        {"machine", origin.machine},
        {"tracks", options.tracks},
        {"methods", methods},
        {"fp", scenes.false_positive_rates},
        {"range", scenes.ranges_m},
        {"every", scenes.every_m},
        {"noise", scenes.noise_sigma_m.value_or(0.0)},
        {"pose_noise", {scenes.pose_noise_lateral_m.value_or(0.0), scenes.pose_noise_yaw_rad.value_or(0.0)}},
        {"miss", scenes.miss_rate.value_or(0.0)},
        {"color", scenes.with_color},
        {"color_error", scenes.color_error_rate},
        {"confidence", scenes.with_confidence},
        {"seed", scenes.seed},
        {"threads", options.run.threads},
        {"candidates", options.run.limits.keep_candidates}};
    if (origin.commit == "unknown" || origin.commit.ends_with("-dirty")) record["program"] = program_hash();
    if (!scenes.conditions.empty()) record["condition"] = condition_names(scenes);
    if (scenes.persistent) record["persist"] = *scenes.persistent;
    if (scenes.nearest) record["nearest"] = *scenes.nearest;
    if (std::isfinite(options.run.limits.time_limit_ms))
        record["time_limit_ms"] = options.run.limits.time_limit_ms;
    if (options.shard.count > 1) record["shard"] = {options.shard.index, options.shard.count};
    return record.dump();
}

FolderLock open_run(const fs::path& directory, const std::string& record, bool overwrite) {
    std::error_code failure;
    fs::create_directories(directory, failure);
    if (failure) throw InputError(directory, 0, "", "cannot be made: " + failure.message());
    FolderLock lock(directory);
    const std::vector<fs::path> earlier = files_of_a_run(directory);
    if (fs::exists(directory / kRunFile)) {
        const std::string stored = read_run_record(directory);
        if (stored == record) return lock;
        if (!overwrite) {
            throw InputError(directory, 0, "",
                             fmt::format("holds a comparison that differs in {}; --overwrite replaces it",
                                         fmt::join(differing_keys(stored, record), ", ")));
        }
    } else if (!earlier.empty() && !overwrite) {
        throw InputError(directory, 0, "",
                         fmt::format("holds {}, but not the {} that belongs to it; --overwrite replaces it",
                                     earlier.front().filename().string(), kRunFile));
    }
    for (const fs::path& file : earlier) fs::remove(file);
    AtomicFile file(directory / kRunFile);
    file.stream() << record << '\n';
    file.commit();
    return lock;
}

std::string read_run_record(const fs::path& directory) {
    const fs::path file = directory / kRunFile;
    std::ifstream stream(file);
    std::string record;
    if (!std::getline(stream, record)) throw InputError(file, 0, "", "cannot be read");
    if (!nlohmann::json::accept(record)) throw InputError(file, 1, "", "is no JSON");
    return record;
}

}  // namespace conelane::experiments
