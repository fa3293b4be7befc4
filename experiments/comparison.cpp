#include "experiments/comparison.hpp"

#include "experiments/files/atomic_file.hpp"
#include "experiments/files/input_error.hpp"
#include "experiments/files/lane_file.hpp"
#include "experiments/results.hpp"
#include "experiments/scenes/scene_set.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace conelane::experiments {
namespace {

/// Everything that the numbers of a comparison depend on.
std::string describe(const ComparisonOptions& options) {
    nlohmann::ordered_json parameters;
    for (const RldParameterField& field : rld_parameter_fields()) {
        parameters[std::string(field.key)] = options.run.method.rld_parameters.*field.value;
    }
    parameters["pairing"] = to_string(options.run.method.rld_parameters.pairing);
    nlohmann::ordered_json run{
        {"tracks", options.tracks},
        {"every", options.scenes.every_m},
        {"noise", options.scenes.noise_sigma_m},
        {"pose_noise", {options.scenes.pose_noise_lateral_m, options.scenes.pose_noise_yaw_rad}},
        {"miss", options.scenes.miss_rate},
        {"color", options.scenes.with_color},
        {"seed", options.scenes.seed},
        {"threads", options.run.threads},
        {"rld_parameters", parameters}};
    if (options.run.method.nearest) run["nearest"] = *options.run.method.nearest;
    if (std::isfinite(options.run.limits.time_limit_ms))
        run["time_limit_ms"] = options.run.limits.time_limit_ms;
    return run.dump();
}

void write_text(const std::filesystem::path& file, const std::string& text) {
    AtomicFile output(file);
    output.stream() << text;
    output.commit();
}

}  // namespace

std::vector<ScoreRow> compare(const ComparisonOptions& options) {
    std::vector<const MethodEntry*> chosen;
    for (const std::string& name : options.methods) chosen.push_back(&find_method(name));
    std::error_code failure;
    std::filesystem::create_directories(options.directory, failure);
    if (failure) throw InputError(options.directory, 0, "", "cannot be made: " + failure.message());

    const SceneSet set = make_scene_set(options.tracks, options.scenes);
    write_scene_set(options.directory / "scenes.scenes.jsonl", set);

    std::vector<KeyedScore> scores;
    for (const MethodEntry* method : chosen) {
        const std::vector<LaneRecord> records = run(*method, set.scenes, options.run);
        const std::filesystem::path lanes_file =
            options.directory / fmt::format("{}.lanes.jsonl", method->name);
        write_lanes(lanes_file, records);
        std::ranges::move(score_records(set.scenes, set.tracks, records, lanes_file),
                          std::back_inserter(scores));
    }
    std::vector<ScoreRow> rows = summarise_by_key(scores);
    write_results(options.directory / "results.jsonl", rows, describe(options));
    write_text(options.directory / "table.txt", score_table(rows));
    return rows;
}

}  // namespace conelane::experiments
