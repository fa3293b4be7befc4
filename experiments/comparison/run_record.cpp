#include "experiments/comparison/run_record.hpp"

#include "experiments/files/atomic_file.hpp"
#include "experiments/files/input_error.hpp"
#include "experiments/provenance.hpp"

#include <cmath>
#include <fstream>
#include <iterator>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace conelane::experiments {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRunFile = "run.json";

bool is_of_a_run(const fs::path& file) {
    const std::string name = file.filename().string();
    return name.ends_with(".lanes.jsonl") || name.ends_with(".lanes.jsonl.part") || name == "results.jsonl" ||
           name == "scores.jsonl" || name == "table.txt" || name == kRunFile;
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
    nlohmann::ordered_json record{{"commit", origin.commit},
                                  {"compiler", origin.compiler},
                                  {"machine", origin.machine},
                                  {"tracks", options.tracks},
                                  {"methods", methods},
                                  {"fp", scenes.false_positive_rates},
                                  {"range", scenes.ranges_m},
                                  {"every", scenes.every_m},
                                  {"noise", scenes.noise_sigma_m},
                                  {"pose_noise", {scenes.pose_noise_lateral_m, scenes.pose_noise_yaw_rad}},
                                  {"miss", scenes.miss_rate},
                                  {"color", scenes.with_color},
                                  {"color_error", scenes.color_error_rate},
                                  {"confidence", scenes.with_confidence},
                                  {"seed", scenes.seed},
                                  {"threads", options.run.threads},
                                  {"candidates", options.run.limits.keep_candidates}};
    if (scenes.nearest) record["nearest"] = *scenes.nearest;
    if (std::isfinite(options.run.limits.time_limit_ms))
        record["time_limit_ms"] = options.run.limits.time_limit_ms;
    if (options.shard.count > 1) record["shard"] = {options.shard.index, options.shard.count};
    return record.dump();
}

void open_run(const fs::path& directory, const std::string& record) {
    std::error_code failure;
    fs::create_directories(directory, failure);
    if (failure) throw InputError(directory, 0, "", "cannot be made: " + failure.message());
    if (fs::exists(directory / kRunFile)) {
        const bool changed_sources = record.find("-dirty\"") != std::string::npos;
        if (!changed_sources && read_run_record(directory) == record) return;
    }
    for (const fs::directory_entry& entry : fs::directory_iterator(directory)) {
        if (is_of_a_run(entry.path())) fs::remove(entry.path());
    }
    AtomicFile file(directory / kRunFile);
    file.stream() << record << '\n';
    file.commit();
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
