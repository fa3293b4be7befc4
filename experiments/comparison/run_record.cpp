#include "experiments/comparison/run_record.hpp"

#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/file_hash.hpp"
#include "evaluation/formats/json_node.hpp"
#include "evaluation/formats/parameter_tag.hpp"
#include "evaluation/formats/provenance.hpp"
#include "evaluation/formats/scene_options_json.hpp"
#include "evaluation/input_error.hpp"
#include "experiments/comparison/echo_floor.hpp"

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
    constexpr std::array<std::string_view, 8> kNames{
        kRunFile, "results.jsonl",       "scores.jsonl",       "table.txt",
        "folds",  "scenes.scenes.jsonl", "scenes.tracks.json", kEchoFloorFile};
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

/// The keys in which two records differ; "its record" if the texts differ otherwise.
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
    if (parameters.learned_costs) json["learned_costs"] = tag_of("", parameters).hash.value();
    return json;
}

nlohmann::ordered_json to_json(const Method& method, const DetectorOptions& options) {
    nlohmann::ordered_json json{{"name", method.name}};
    if (method.outside) json = nlohmann::ordered_json::parse(outside_detector_json(*method.outside));
    if (method.is_lanes_file()) {
        json["hash"] = file_hash(method.outside->source);
        if (json["hash"].empty()) throw InputError(method.outside->source, 0, "", "cannot be read");
    }
    if (method.nearest) json["nearest"] = *method.nearest;
    if (method.is_rld()) json["rld_parameters"] = to_json(method.rld_parameters(options));
    return json;
}

}  // namespace

std::string run_record(const ComparisonOptions& options) {
    const Provenance origin = provenance();
    nlohmann::ordered_json methods = nlohmann::ordered_json::array();
    for (const Method& method : options.methods) methods.push_back(to_json(method, options.run.detector));
    nlohmann::ordered_json record{{"commit", origin.commit},
                                  {"compiler", origin.compiler},
                                  {"machine", origin.machine},
                                  {"tracks", options.tracks},
                                  {"methods", methods}};
    record.update(scene_options_json(options.scenes));
    record["threads"] = options.run.threads;
    record["candidates"] = options.run.limits.keep_candidates;
    if (!options.cross_validation.empty())
        record["cross_validation"] = nlohmann::ordered_json::parse(options.cross_validation);
    if (origin.commit == "unknown" || origin.commit.ends_with("-dirty"))
        record["program"] = file_hash("/proc/self/exe");
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
    remove_abandoned_files(directory);
    const std::vector<fs::path> earlier = files_of_a_run(directory);
    if (fs::exists(directory / kRunFile)) {
        // A record that cannot be read will be replaced, so it is ignored.
        std::string stored;
        try {
            stored = read_run_record(directory);
        } catch (const InputError&) {
            if (!overwrite) throw;
        }
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
    for (const fs::path& file : earlier) fs::remove_all(file);
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
    with_json_line(record, file, 1, [](const JsonNode& /*checked*/) {});
    return record;
}

}  // namespace conelane::experiments
