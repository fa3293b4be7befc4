#include "experiments/comparison/results.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/formats/provenance.hpp"
#include "evaluation/input_error.hpp"
#include "evaluation/outside/detector_card_fields.hpp"
#include "evaluation/progress/progress.hpp"
#include "evaluation/scoring/statistics.hpp"

#include <algorithm>
#include <exception>
#include <iterator>
#include <map>
#include <string>
#include <type_traits>
#include <utility>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>

namespace conelane::experiments {
namespace {

// Else a vector that grows would copy the records, which the scores refer to.
static_assert(std::is_nothrow_move_constructible_v<ScoredMethod>);

ScoreKey key_of(const AnnotatedScene& scene, const LaneRecord& record) {
    return {record.detector, scene.false_positive_rate, scene.range_m, record.nearest, scene.condition};
}

nlohmann::ordered_json score_line(const ScoredRecord& scored) {
    const auto& [scene, record, score, failure] = scored;
    nlohmann::ordered_json line{{"scene", record->scene}, {"method", record->detector}};
    const auto put_if_known = [&](const char* key, const auto& value) {
        if (value) line[key] = *value;
    };
    put_if_known("nearest", record->nearest);
    line["track"] = scene->track;
    if (!scene->condition.empty()) line["condition"] = scene->condition;
    put_if_known("false_positive_rate", scene->false_positive_rate);
    put_if_known("range", scene->range_m);
    line["status"] = to_string(record->answer.status);
    if (record->checked) line["checked"] = true;
    line["category"] = to_string(score.category);
    if (score.trained_on) line["trained_on"] = true;
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
    put_if_known("confidence", score.confidence);
    put_if_known("trusted_m", score.trusted_m);
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
    put_if_known("self_timed_ms", record->self_timed_ms);
    return line;
}

/// The times that a method reports itself.
std::vector<double> self_times_ms(std::span<const ScoredRecord> scored, const ScoreKey* row = nullptr) {
    std::vector<double> times_ms;
    for (const auto& [scene, record, score, failure] : scored) {
        if (record->self_timed_ms && (row == nullptr || key_of(*scene, *record) == *row))
            times_ms.push_back(*record->self_timed_ms);
    }
    return times_ms;
}

/// The number of errors, and the first message; empty if there is no error.
std::string note_on_errors(std::span<const ScoredRecord> scored) {
    std::size_t errors = 0;
    std::string first;
    for (const ScoredRecord& record : scored) {
        if (record.record->answer.status != LaneStatus::error) continue;
        if (++errors == 1) first = record.record->scene + ": " + record.record->answer.message;
    }
    if (errors == 0) return "";
    return fmt::format("    {} of {} answers are errors, the first to {}\n", errors, scored.size(), first);
}

std::string note_on_latency(const MethodRecord& method, std::span<const ScoredRecord> scored) {
    if (!method.solver.empty()) {
        return fmt::format("RLD by a solver from outside, {} formulation; latency includes files and pipes",
                           to_string(method.formulation.value_or(Formulation::tight)));
    }
    if (!method.lanes.empty()) return "latency is self-timed, as the lanes file says";
    const std::vector<double> own_ms = self_times_ms(scored);
    if (own_ms.empty()) return "latency is the round trip of a scene and its answer";
    return fmt::format(
        "latency is the round trip of a scene and its answer; self-timed {:.2f} ms (median), {:.2f} (p95)",
        median(own_ms), quantile(own_ms, 0.95));
}

double travel_m(const AnnotatedScene& from, const AnnotatedScene& to) {
    return (to.scene.pose.position - from.scene.pose.position).norm();
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
    const Pose& pose = scene.scene.pose;
    LaneOutline outline;
    if (record.points) {
        outline = {record.points->left, record.points->right, record.answer.lane.closed};
        score = score_outline(scene, outline, record.latency_ms, truth.boundaries);
        line = centre_line_of(outline, pose);
    } else if (!record.centre_line.empty()) {
        score = score_centre_line(scene, record.centre_line, record.latency_ms, truth.boundaries);
        line = centre_line_of(record.centre_line, pose);
    } else {
        score = conelane::score(scene, record.answer, record.latency_ms, record.nearest, truth.boundaries);
        if (record.answer.status == LaneStatus::found) {
            outline = outline_of(record.answer.lane, scene.scene);
            line = centre_line_of(outline, pose);
        }
    }
    scored.failure = lane_failure(scene, outline, score, truth.boundaries);
    if (score.usable().value_or(false) && !truth.centre_line.empty())
        score.centre_line_error = centre_line_error(line, truth.centre_line);
}

ScoredMethod RecordScorer::score(MethodRecord method, std::vector<LaneRecord> records,
                                 const std::filesystem::path& lanes_file) const {
    ScoredMethod scored{std::move(method), std::move(records)};
    const std::size_t count = scored.records.size();
    std::vector<const Truth*> truths;
    truths.reserve(count);
    for (const LaneRecord& record : scored.records) truths.push_back(&truth_of(record, lanes_file));
    const std::string label =
        count == 0 ? scored.method.name : key_of(*truths[0]->scene, scored.records[0]).detector_label();
    const bool optimises = std::ranges::any_of(
        scored.records, [](const LaneRecord& record) { return record.answer.optimality.has_value(); });
    std::vector<ScoredRecord> all(count);
    std::vector<CentreLine> lines(count);
    std::vector<std::exception_ptr> failures(count);
    Progress progress("scoring " + lanes_file.filename().string(), count);
    oneapi::tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
        progress.advance();
        if (!truths[i]->counts) return;
        try {
            all[i] = {truths[i]->scene, &scored.records[i], {}};
            score(*truths[i], all[i], lines[i]);
        } catch (const InvalidInput& invalid) {
            failures[i] = std::make_exception_ptr(
                InputError(lanes_file, scored.records[i].line, invalid.key(), invalid.what()));
        }
    });
    for (std::size_t i = 0; i < count; ++i) {
        if (failures[i]) std::rethrow_exception(failures[i]);
        if (!truths[i]->counts) continue;
        const auto& [scene, record, of_scene, failure] = all[i];
        SceneScore& score = all[i].score;
        if (i > 0 && truths[i - 1]->counts && same_lap(*truths[i - 1]->scene, *scene) &&
            travel_m(*truths[i - 1]->scene, *scene) < kCentreLineLength_m) {
            score.steady = is_steady(lines[i - 1], lines[i]);
        }
        score.trained_on = scored.method.training_courses.contains(scene->track);
        if (optimises && record->answer.status == LaneStatus::none)
            score.solved_to_optimality = record->latency_ms <= kRldTimeLimit_ms;
        scored.scores.push_back(std::move(all[i]));
    }
    if (count != scene_count_) {
        throw InputError(lanes_file, 0, "scene",
                         fmt::format("{} answers {} of {} scenes", label, count, scene_count_));
    }
    return scored;
}

std::vector<ScoreRow> ScoredMethod::rows() const {
    std::vector<KeyedScore> keyed;
    keyed.reserve(scores.size());
    for (const ScoredRecord& record : scores)
        keyed.push_back({key_of(*record.scene, *record.record), record.score});
    return summarise_by_key(keyed);
}

void write_scores(std::ostream& output, std::span<const ScoredMethod> methods) {
    for (const ScoredMethod& method : methods) {
        for (const ScoredRecord& record : method.scores) output << score_line(record).dump() << '\n';
    }
}

void write_results(std::ostream& output, std::span<const ScoredMethod> methods, const std::string& run) {
    const Provenance origin = provenance();
    const auto run_json = nlohmann::ordered_json::parse(run);
    for (const ScoredMethod& scored : methods) {
        const MethodRecord& method = scored.method;
        for (const ScoreRow& row : scored.rows()) {
            nlohmann::ordered_json line = summary_json(row);
            if (!method.outside().empty()) {
                line["outside"] = method.outside();
                const std::vector<double> own_ms = self_times_ms(scored.scores, &row.key);
                if (!own_ms.empty())
                    line["self_timed_ms"] = {{"median", median(own_ms)}, {"p95", quantile(own_ms, 0.95)}};
                if (method.card) line["card"] = value_json(*method.card, "card");
            }
            line["commit"] = origin.commit;
            line["compiler"] = origin.compiler;
            line["machine"] = origin.machine;
            line["run"] = run_json;
            output << to_line(line) << '\n';
        }
    }
}

std::string wide_table(std::span<const ScoredMethod> methods) {
    std::vector<ScoreRow> rows;
    std::map<std::string, std::vector<ScoredRecord>> outside;  // of all cone-set sizes together
    for (const ScoredMethod& scored : methods) {
        std::ranges::move(scored.rows(), std::back_inserter(rows));
        if (!scored.method.outside().empty())
            std::ranges::copy(scored.scores, std::back_inserter(outside[scored.method.name]));
    }
    std::string notes;
    for (const ScoredMethod& scored : methods) {
        const MethodRecord& method = scored.method;
        const auto scores = outside.extract(method.name);  // of its first cone-set size
        if (scores.empty()) continue;
        notes += fmt::format("  {}: {}\n", method.name, note_on_latency(method, scores.mapped()));
        if (method.card) notes += "    " + method.card->summary() + '\n';
        notes += note_on_errors(scores.mapped());
    }
    return score_table(rows) + (notes.empty() ? "" : "methods from outside\n" + notes);
}

}  // namespace conelane::experiments
