#include "experiments/comparison/results.hpp"

#include "conelane/invalid_input.hpp"
#include "experiments/comparison/runner.hpp"
#include "experiments/files/atomic_file.hpp"
#include "experiments/files/input_error.hpp"
#include "experiments/provenance.hpp"

#include <algorithm>
#include <exception>
#include <map>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>
#include <oneapi/tbb/parallel_for.h>

namespace conelane::experiments {
namespace {

ScoreKey key_of(const AnnotatedScene& scene, const LaneRecord& record) {
    return {record.method, scene.false_positive_rate, scene.range_m, record.nearest};
}

nlohmann::ordered_json score_line(const ScoredRecord& scored) {
    const auto& [scene, record, score, failure] = scored;
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
    put_if_known("usable", score.usable());
    if (failure) line["cause"] = to_string(*failure);
    put_if_known("iou", score.iou);
    line["lane_length_m"] = score.lane_length_m;
    line["ground_truth_length_m"] = score.ground_truth_length_m;
    put_if_known("divergence_m", score.divergence_distance_m);
    if (score.centre_line_error) {
        const CentreLineError& error = *score.centre_line_error;
        if (!error.lateral_m.empty()) {
            const std::vector<double> lateral_m(error.lateral_m.begin(), error.lateral_m.end());
            line["lateral_median_m"] = median(lateral_m);
            line["lateral_max_m"] = std::ranges::max(lateral_m);
        }
        put_if_known("heading_error_rad", error.heading_rad);
    }
    put_if_known("steady", score.steady);
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

RecordScorer::RecordScorer(std::span<const AnnotatedScene> scenes, const TrackBoundariesByName& tracks)
    : scene_count_(scenes.size()) {
    std::vector<Truth> truths(scenes.size());
    oneapi::tbb::parallel_for(std::size_t{0}, scenes.size(), [&](std::size_t i) {
        const auto track = tracks.find(scenes[i].track);
        Truth& truth = truths[i];
        truth.scene = &scenes[i];
        truth.boundaries = track == tracks.end() ? nullptr : &track->second;
        truth.counts = counts(scenes[i], truth.boundaries);
        if (truth.counts && scenes[i].ground_truth) {
            truth.centre_line =
                centre_line_of(outline_of(*scenes[i].ground_truth, scenes[i].scene), scenes[i].scene.pose);
        }
    });
    for (Truth& truth : truths) truth_of_.emplace(truth.scene->scene.id, std::move(truth));
}

const RecordScorer::Truth& RecordScorer::truth_of(const LaneRecord& record,
                                                  const std::filesystem::path& file) const {
    const auto truth = truth_of_.find(record.scene);
    if (truth == truth_of_.end())
        throw InputError(file, record.line, "scene", "'" + record.scene + "' is not in the scenes file");
    return truth->second;
}

void RecordScorer::score(const Truth& truth, ScoredRecord& scored, CentreLine& line) {
    const AnnotatedScene& scene = *truth.scene;
    const LaneRecord& record = *scored.record;
    SceneScore& score = scored.score;
    score = experiments::score(scene, record.answer, record.latency_ms, record.nearest, truth.boundaries);
    LaneOutline outline;
    if (record.answer.status == LaneStatus::found) {
        outline = outline_of(record.answer.lane, scene.scene);
        line = centre_line_of(outline, scene.scene.pose);
    }
    scored.failure = lane_failure(scene, outline, score, truth.boundaries);
    if (score.usable().value_or(false) && !truth.centre_line.empty())
        score.centre_line_error = centre_line_error(line, truth.centre_line);
}

std::vector<ScoredRecord> RecordScorer::score(std::span<const LaneRecord> records,
                                              const std::filesystem::path& lanes_file) {
    std::vector<const Truth*> truths;
    truths.reserve(records.size());
    std::map<std::string, std::size_t> answered;  // by method and cone-set size
    for (const LaneRecord& record : records) {
        truths.push_back(&truth_of(record, lanes_file));
        ++answered[key_of(*truths.back()->scene, record).method_label()];
    }
    std::vector<ScoredRecord> all(records.size());
    std::vector<CentreLine> lines(records.size());
    std::vector<std::exception_ptr> failures(records.size());
    oneapi::tbb::parallel_for(std::size_t{0}, records.size(), [&](std::size_t i) {
        if (!truths[i]->counts) return;
        try {
            all[i] = {truths[i]->scene, &records[i], {}};
            score(*truths[i], all[i], lines[i]);
        } catch (const InvalidInput& invalid) {
            failures[i] = std::make_exception_ptr(
                InputError(lanes_file, records[i].line, invalid.key(), invalid.what()));
        }
    });
    std::vector<ScoredRecord> scored;
    for (std::size_t i = 0; i < records.size(); ++i) {
        if (failures[i]) std::rethrow_exception(failures[i]);
        if (!truths[i]->counts) continue;
        if (i > 0 && truths[i - 1]->counts && records[i].method == records[i - 1].method &&
            records[i].nearest == records[i - 1].nearest &&
            same_lap(*truths[i - 1]->scene, *truths[i]->scene)) {
            all[i].score.steady = is_steady(lines[i - 1], lines[i]);
        }
        scored.push_back(std::move(all[i]));
    }
    for (const auto& [name, count] : answered) {
        if (count != scene_count_) {
            throw InputError(lanes_file, 0, "scene",
                             name + " answers " + std::to_string(count) + " of " +
                                 std::to_string(scene_count_) + " scenes");
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
