#include "experiments/comparison/results.hpp"

#include "conelane/invalid_input.hpp"
#include "experiments/files/atomic_file.hpp"
#include "experiments/files/input_error.hpp"
#include "experiments/provenance.hpp"

#include <map>
#include <string>
#include <unordered_map>
#include <utility>

#include <nlohmann/json.hpp>

namespace conelane::experiments {
namespace {

ScoreKey key_of(const AnnotatedScene& scene, const LaneRecord& record) {
    return {record.method, scene.false_positive_rate, scene.range_m, record.nearest};
}

nlohmann::ordered_json score_line(const ScoredRecord& scored) {
    const auto& [scene, record, score] = scored;
    nlohmann::ordered_json line{{"scene", record->scene}, {"method", record->method}};
    const auto put_if_known = [&](const char* key, const auto& value) {
        if (value) line[key] = *value;
    };
    put_if_known("nearest", record->nearest);
    line["track"] = scene->track;
    put_if_known("false_positive_rate", scene->false_positive_rate);
    put_if_known("range", scene->range_m);
    line["status"] = to_string(record->answer.status);
    if (record->checked) line["checked"] = true;
    line["category"] = to_string(score.category);
    line["iou"] = score.iou;
    line["lane_length_m"] = score.lane_length_m;
    line["ground_truth_length_m"] = score.ground_truth_length_m;
    put_if_known("divergence_m", score.divergence_distance_m);
    if (score.accuracy) {
        line["accurate"] = score.accurate();
        line["accuracy"] = {{"cones", score.accuracy->cones},
                            {"sides", score.accuracy->sides},
                            {"crossings", score.accuracy->crossings},
                            {"width", score.accuracy->width}};
    }
    put_if_known("solved", score.solved_to_optimality);
    if (const auto& optimality = record->answer.optimality) {
        line["objective"] = optimality->objective;
        if (optimality->bound > -1e300) line["bound"] = optimality->bound;
        line["optimal"] = optimality->optimal;
    }
    if (score.enumeration) {
        line["iterations"] = score.enumeration->iterations;
        line["complete"] = score.enumeration->complete;
        put_if_known("best_candidate_iou", score.enumeration->best_iou);
        put_if_known("first_near_iteration", score.enumeration->first_near_ground_truth_iteration);
    }
    line["cones"] = std::min(scene->scene.cones.size(), record->nearest.value_or(scene->scene.cones.size()));
    line["latency_ms"] = score.latency_ms;
    return line;
}

}  // namespace

std::vector<ScoredRecord> score_records(std::span<const AnnotatedScene> scenes,
                                        const TrackBoundariesByName& tracks,
                                        std::span<const LaneRecord> records,
                                        const std::filesystem::path& lanes_file) {
    std::unordered_map<std::string, const AnnotatedScene*> scene_of;
    for (const AnnotatedScene& scene : scenes) scene_of.emplace(scene.scene.id, &scene);
    std::vector<ScoredRecord> scored;
    std::map<std::string, std::size_t> answered;  // by method and cone-set size
    for (const LaneRecord& record : records) {
        const auto scene = scene_of.find(record.scene);
        if (scene == scene_of.end()) {
            throw InputError(lanes_file, record.line, "scene",
                             "'" + record.scene + "' is not in the scenes file");
        }
        const AnnotatedScene& annotated = *scene->second;
        ++answered[key_of(annotated, record).method_label()];
        if (!counts(annotated)) continue;
        const auto track = tracks.find(annotated.track);
        try {
            scored.push_back({&annotated, &record,
                              score(annotated, record.answer, record.latency_ms, record.nearest,
                                    track == tracks.end() ? nullptr : &track->second)});
        } catch (const InvalidInput& invalid) {
            throw InputError(lanes_file, record.line, invalid.key(), invalid.what());
        }
    }
    for (const auto& [name, count] : answered) {
        if (count != scenes.size()) {
            throw InputError(lanes_file, 0, "scene",
                             name + " answers " + std::to_string(count) + " of " +
                                 std::to_string(scenes.size()) + " scenes");
        }
    }
    return scored;
}

std::vector<ScoreRow> summarise(std::span<const ScoredRecord> scored) {
    std::vector<KeyedScore> keyed;
    keyed.reserve(scored.size());
    for (const ScoredRecord& record : scored)
        keyed.push_back({key_of(*record.scene, *record.record), record.score});
    return summarise_by_key(keyed);
}

void write_scores(const std::filesystem::path& file, std::span<const ScoredRecord> scored) {
    AtomicFile output(file);
    for (const ScoredRecord& record : scored) output.stream() << score_line(record).dump() << '\n';
    output.commit();
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
