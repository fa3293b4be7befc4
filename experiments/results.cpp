#include "experiments/results.hpp"

#include "experiments/files/atomic_file.hpp"
#include "experiments/files/input_error.hpp"
#include "experiments/provenance.hpp"
#include "experiments/scoring/score.hpp"
#include "model/invalid_input.hpp"

#include <set>
#include <string>
#include <unordered_map>
#include <utility>

#include <nlohmann/json.hpp>

namespace conelane::experiments {

std::vector<KeyedScore> score_records(std::span<const AnnotatedScene> scenes,
                                      const TrackBoundariesByName& tracks,
                                      std::span<const LaneRecord> records,
                                      const std::filesystem::path& lanes_file) {
    std::unordered_map<std::string, const AnnotatedScene*> scene_of;
    for (const AnnotatedScene& scene : scenes) scene_of.emplace(scene.scene.id, &scene);
    std::vector<KeyedScore> scores;
    std::map<std::string, std::size_t> answered;  // by row name
    for (std::size_t i = 0; i < records.size(); ++i) {
        const LaneRecord& record = records[i];
        const auto scene = scene_of.find(record.scene);
        if (scene == scene_of.end()) {
            throw InputError(lanes_file, i + 1, "scene", "'" + record.scene + "' is not in the scenes file");
        }
        const AnnotatedScene& annotated = *scene->second;
        const ScoreKey key{record.method, annotated.false_positive_rate, annotated.range_m, record.nearest};
        ++answered[key.method_label()];
        if (!counts(annotated)) continue;
        const auto track = tracks.find(annotated.track);
        try {
            scores.push_back({key, score(annotated, record.answer, record.latency_ms, record.nearest,
                                         track == tracks.end() ? nullptr : &track->second)});
        } catch (const InvalidInput& invalid) {
            throw InputError(lanes_file, i + 1, invalid.key(), invalid.what());
        }
    }
    for (const auto& [name, count] : answered) {
        if (count != scenes.size()) {
            throw InputError(lanes_file, 0, "scene",
                             name + " answers " + std::to_string(count) + " of " +
                                 std::to_string(scenes.size()) + " scenes");
        }
    }
    return scores;
}

void write_results(const std::filesystem::path& file, std::span<const ScoreRow> rows,
                   const std::string& run) {
    const Provenance origin = provenance();
    AtomicFile output(file);
    for (const ScoreRow& row : rows) {
        nlohmann::ordered_json line = nlohmann::ordered_json::parse(summary_json(row));
        line["commit"] = origin.commit;
        line["compiler"] = origin.compiler;
        line["machine"] = origin.machine;
        line["run"] = nlohmann::ordered_json::parse(run);
        output.stream() << line.dump() << '\n';
    }
    output.commit();
}

}  // namespace conelane::experiments
