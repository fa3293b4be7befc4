#include "experiments/comparison/run_record.hpp"

#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/file_text.hpp"
#include "evaluation/formats/parameter_tag.hpp"
#include "evaluation/formats/scene_options_fields.hpp"
#include "evaluation/formats/scene_set.hpp"
#include "evaluation/input_error.hpp"
#include "evaluation/outside/detector_card_fields.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace conelane {

using experiments::MethodRecord;
using experiments::RunRecord;

template <>
struct Choices<Formulation> {
    static constexpr std::array all{Formulation::tight, Formulation::paper};
};
template <>
inline constexpr std::tuple kFields<Provenance>{Field{"commit", &Provenance::commit},
                                                Field{"compiler", &Provenance::compiler},
                                                Field{"machine", &Provenance::machine}};

/// All parameters, by the names that files of parameters have.
struct EveryParameter {
    static void read(const JsonNode& json, MethodRecord::Rld& rld) {
        for_each(rld.parameters,
                 [&](const std::string& key, auto& value) { read_value(json.member(key), value); });
    }
    static void put(nlohmann::ordered_json& json, const MethodRecord::Rld& rld, const std::string& place) {
        for_each(rld.parameters, [&](const std::string& key, const auto& value) {
            json[key] = value_json(value, place + key);
        });
    }

  private:
    static void for_each(auto& parameters, const auto& use) {
        for (const RldParameterField& field : rld_parameter_fields())
            use(std::string(field.key), parameters.*field.value);
        use("pairing", parameters.pairing);
        for (const RldParameterField& field : rld_extra_fields())
            use(std::string(field.key), parameters.*field.value);
        use("use_confidence", parameters.use_confidence);
        use("forbid_crossing", parameters.forbid_crossing);
    }
};
template <>
inline constexpr std::tuple kFields<MethodRecord::Rld>{
    EveryParameter{}, Field{"learned_costs", &MethodRecord::Rld::learned_costs, Absent::if_empty}};

template <>
inline constexpr std::tuple kFields<MethodRecord>{Field{"name", &MethodRecord::name},
                                                  Field{"exec", &MethodRecord::exec, Absent::if_empty},
                                                  Field{"lanes", &MethodRecord::lanes, Absent::if_empty},
                                                  Field{"solver", &MethodRecord::solver, Absent::if_empty},
                                                  Field{"formulation", &MethodRecord::formulation},
                                                  Field{"card", &MethodRecord::card},
                                                  Field{"hash", &MethodRecord::hash, Absent::if_empty},
                                                  Field{"nearest", &MethodRecord::nearest},
                                                  Field{"rld_parameters", &MethodRecord::rld_parameters}};

/// `cross_validation`: any object, passed on as text. The reader of a file sets it, since a JsonNode has no
/// text.
struct Folds {
    static void read(const JsonNode& json, RunRecord& /*run*/) {
        if (const auto folds = json.find("cross_validation")) folds->require_object();
    }
    static void put(nlohmann::ordered_json& json, const RunRecord& run, const std::string& /*place*/) {
        if (!run.cross_validation.empty())
            json["cross_validation"] = nlohmann::ordered_json::parse(run.cross_validation);
    }
};

/// `shard`: [index, count], absent for the whole run.
struct ShardPair {
    static void read(const JsonNode& json, RunRecord& run) {
        std::pair<std::size_t, std::size_t> shard{run.shard.index, run.shard.count};
        if (const auto found = json.find("shard")) read_value(*found, shard);
        run.shard = {shard.first, shard.second};
    }
    static void put(nlohmann::ordered_json& json, const RunRecord& run, const std::string& /*place*/) {
        if (run.shard.count > 1) json["shard"] = {run.shard.index, run.shard.count};
    }
};

template <>
inline constexpr std::tuple kFields<RunRecord>{Inlined{&RunRecord::origin},
                                               Field{"tracks", &RunRecord::tracks},
                                               Field{"methods", &RunRecord::methods},
                                               Inlined{&RunRecord::scenes},
                                               Field{"threads", &RunRecord::threads},
                                               Field{"candidates", &RunRecord::candidates},
                                               Folds{},
                                               Field{"program", &RunRecord::program, Absent::if_empty},
                                               Field{"time_limit_ms", &RunRecord::time_limit_ms},
                                               ShardPair{}};

}  // namespace conelane

namespace conelane::experiments {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRunFile = "run.json";

nlohmann::ordered_json json_of(const RunRecord& record) {
    return value_json(record, "run");
}

std::set<std::string> courses_of(const MethodRecord& method, bool is_cross_validated) {
    if (method.outside().empty())
        return is_cross_validated ? std::set<std::string>{} : training_courses(method.name);
    if (!method.card || !method.card->training_courses) return {};
    return {method.card->training_courses->begin(), method.card->training_courses->end()};
}

bool is_of_a_run(const fs::path& file) {
    const std::string name = file.filename().string();
    constexpr std::array<std::string_view, 8> kNames{kRunFile,
                                                     "results.jsonl",
                                                     "scores.jsonl",
                                                     "table.txt",
                                                     "folds",
                                                     "scenes.scenes.jsonl",
                                                     "scenes.tracks.json",
                                                     "echo_floor.json"};  // the last one is of version 0.5
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

/// The keys in which the stored record differs. Of one that cannot be read, and will be replaced: one key.
std::vector<std::string> differences_on_disk(const fs::path& directory, const RunRecord& record,
                                             bool overwrite) {
    try {
        return read_run_record(directory).differences(record);
    } catch (const InputError&) {
        if (!overwrite) throw;
        return {kRunFile};
    }
}

}  // namespace

std::string MethodRecord::outside() const {
    return !exec.empty() ? "exec" : !lanes.empty() ? "lanes" : !solver.empty() ? "solver" : "";
}

std::string MethodRecord::lanes_file() const {
    return nearest ? fmt::format("{}.n{:03}.lanes.jsonl", name, *nearest) : name + ".lanes.jsonl";
}

MethodRecord record_of(const Method& method, const DetectorOptions& options, bool is_cross_validated) {
    MethodRecord record{.name = method.name, .nearest = method.nearest};
    if (const auto& outside = method.outside) {
        std::string& source = outside->is_program()      ? record.exec
                              : outside->is_lanes_file() ? record.lanes
                                                         : record.solver;
        source = outside->source;
        record.formulation = outside->formulation;
        record.card = outside->card;
    }
    if (method.is_lanes_file()) {
        record.hash = file_hash(record.lanes);
        if (record.hash.empty()) throw InputError(record.lanes, 0, "", "cannot be read");
    }
    if (method.is_rld()) {
        RldParameters parameters = method.rld_parameters(options);
        std::string learned;
        if (parameters.learned_costs) learned = tag_of("", parameters).hash.value();
        record.rld_parameters = {std::move(parameters), learned};
    }
    record.training_courses = courses_of(record, is_cross_validated);
    return record;
}

RunRecord record_of(const ComparisonOptions& options) {
    RunRecord record{.origin = provenance(),
                     .tracks = options.tracks,
                     .methods = {},
                     .scenes = as_recorded(options.scenes),
                     .threads = options.run.threads,
                     .candidates = options.run.limits.keep_candidates,
                     .cross_validation = options.cross_validation,
                     .shard = options.shard};
    for (const Method& method : options.methods)
        record.methods.push_back(record_of(method, options.run.detector, !options.cross_validation.empty()));
    const std::string& commit = record.origin.commit;
    if (commit == "unknown" || commit.ends_with("-dirty")) record.program = file_hash("/proc/self/exe");
    if (std::isfinite(options.run.limits.time_limit_ms))
        record.time_limit_ms = options.run.limits.time_limit_ms;
    return record;
}

std::string RunRecord::text() const {
    return json_of(*this).dump();
}

std::vector<std::string> RunRecord::differences(const RunRecord& other) const {
    const nlohmann::ordered_json own = json_of(*this);
    const nlohmann::ordered_json others = json_of(other);
    std::vector<std::string> keys;
    for (const auto& [key, value] : own.items()) {
        if (!others.contains(key) || nlohmann::json(others[key]) != nlohmann::json(value))
            keys.push_back(key);
    }
    for (const auto& [key, value] : others.items()) {
        if (!own.contains(key)) keys.push_back(key);
    }
    return keys;
}

RunRecord read_run_record(const fs::path& directory) {
    const fs::path file = directory / kRunFile;
    std::ifstream stream(file);
    std::string line;
    if (!std::getline(stream, line)) throw InputError(file, 0, "", "cannot be read");
    RunRecord record;
    with_json_line(line, file, 1, [&](const JsonNode& json) { read_value(json, record); });
    if (const auto json = nlohmann::json::parse(line); json.contains("cross_validation"))
        record.cross_validation = json["cross_validation"].dump();
    for (MethodRecord& method : record.methods)
        method.training_courses = courses_of(method, !record.cross_validation.empty());
    return record;
}

FolderLock open_run(const fs::path& directory, const RunRecord& record, bool overwrite) {
    std::error_code failure;
    fs::create_directories(directory, failure);
    if (failure) throw InputError(directory, 0, "", "cannot be made: " + failure.message());
    FolderLock lock(directory);
    remove_abandoned_files(directory);
    const std::vector<fs::path> earlier = files_of_a_run(directory);
    if (fs::exists(directory / kRunFile)) {
        const std::vector<std::string> differences = differences_on_disk(directory, record, overwrite);
        if (differences.empty()) return lock;
        if (!overwrite) {
            throw InputError(directory, 0, "",
                             fmt::format("holds a comparison that differs in {}; --overwrite replaces it",
                                         fmt::join(differences, ", ")));
        }
    } else if (!earlier.empty() && !overwrite) {
        throw InputError(directory, 0, "",
                         fmt::format("holds {}, but not the {} that belongs to it; --overwrite replaces it",
                                     earlier.front().filename().string(), kRunFile));
    }
    for (const fs::path& file : earlier) fs::remove_all(file);
    AtomicFile file(directory / kRunFile);
    file.stream() << record.text() << '\n';
    file.commit();
    return lock;
}

}  // namespace conelane::experiments
