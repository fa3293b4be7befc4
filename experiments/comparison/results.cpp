#include "experiments/comparison/results.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/formats/provenance.hpp"
#include "evaluation/input_error.hpp"
#include "evaluation/scoring/statistics.hpp"
#include "experiments/comparison/runner.hpp"
#include "experiments/progress/progress.hpp"

#include <algorithm>
#include <exception>
#include <map>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <oneapi/tbb/parallel_for.h>

namespace conelane::experiments {
namespace {

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

/// The times that detectors report themselves, of the records that `is_meant` selects.
template <typename IsMeant>
std::vector<double> self_times_ms(std::span<const ScoredRecord> scored, IsMeant is_meant) {
    std::vector<double> times_ms;
    for (const ScoredRecord& record : scored) {
        if (record.record->self_timed_ms && is_meant(record))
            times_ms.push_back(*record.record->self_timed_ms);
    }
    return times_ms;
}

nlohmann::ordered_json median_and_p95(const std::vector<double>& times_ms) {
    return {{"median", median(times_ms)}, {"p95", quantile(times_ms, 0.95)}};
}

nlohmann::ordered_json outside_part(const OutsideDetector& detector, const std::vector<double>& own_ms,
                                    const EchoFloor& echo) {
    nlohmann::ordered_json part{{"outside", to_string(detector.kind)}};
    if (!own_ms.empty()) part["self_timed_ms"] = median_and_p95(own_ms);
    if (detector.is_program() && !echo.empty()) part["echo_floor_ms"] = median_and_p95(echo);
    const auto described = nlohmann::ordered_json::parse(outside_detector_json(detector));
    if (described.contains("card")) part["card"] = described["card"];
    return part;
}

/// The number of errors, and the first message; empty if there is no error.
std::string note_on_errors(std::span<const ScoredRecord> scored, const std::string& detector) {
    std::size_t answers = 0;
    std::size_t errors = 0;
    std::string first;
    for (const ScoredRecord& record : scored) {
        if (record.record->detector != detector) continue;
        ++answers;
        if (record.record->answer.status != LaneStatus::error) continue;
        if (++errors == 1) first = record.record->scene + ": " + record.record->answer.message;
    }
    if (errors == 0) return "";
    return fmt::format("    {} of {} answers are errors, the first to {}\n", errors, answers, first);
}

double travel_m(const AnnotatedScene& from, const AnnotatedScene& to) {
    return (to.scene.pose.position - from.scene.pose.position).norm();
}

}  // namespace

std::set<std::string> OutsideDetectors::courses_of(const std::string& detector, bool cross_validated) const {
    const auto outside = std::ranges::find(detectors, detector, &OutsideDetector::name);
    if (outside == detectors.end())
        return cross_validated ? std::set<std::string>{} : training_courses(detector);
    if (!outside->card || !outside->card->training_courses) return {};
    return {outside->card->training_courses->begin(), outside->card->training_courses->end()};
}

RecordScorer::RecordScorer(std::span<const AnnotatedScene> scenes, const TrackBoundariesByName& tracks,
                           CoursesOf courses_of)
    : scene_count_(scenes.size()), courses_of_(std::move(courses_of)) {
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

std::vector<ScoredRecord> RecordScorer::score(std::span<const LaneRecord> records,
                                              const std::filesystem::path& lanes_file) {
    std::vector<const Truth*> truths;
    truths.reserve(records.size());
    std::map<std::string, std::size_t> answered;  // by detector and cone-set size
    std::set<std::string> optimising;             // those among them that state an objective
    for (const LaneRecord& record : records) {
        truths.push_back(&truth_of(record, lanes_file));
        const std::string label = key_of(*truths.back()->scene, record).detector_label();
        ++answered[label];
        if (record.answer.optimality) optimising.insert(label);
    }
    std::vector<ScoredRecord> all(records.size());
    std::vector<CentreLine> lines(records.size());
    std::vector<std::exception_ptr> failures(records.size());
    Progress progress("scoring " + lanes_file.filename().string(), records.size());
    oneapi::tbb::parallel_for(std::size_t{0}, records.size(), [&](std::size_t i) {
        progress.advance();
        if (!truths[i]->counts) return;
        try {
            all[i] = {truths[i]->scene, &records[i], {}};
            score(*truths[i], all[i], lines[i]);
        } catch (const InvalidInput& invalid) {
            failures[i] = std::make_exception_ptr(
                InputError(lanes_file, records[i].line, invalid.key(), invalid.what()));
        }
    });
    std::map<std::string, std::set<std::string>> courses;  // by detector
    for (const LaneRecord& record : records) {
        if (!courses.contains(record.detector))
            courses.emplace(record.detector, courses_of_(record.detector));
    }
    std::vector<ScoredRecord> scored;
    for (std::size_t i = 0; i < records.size(); ++i) {
        if (failures[i]) std::rethrow_exception(failures[i]);
        if (!truths[i]->counts) continue;
        if (i > 0 && truths[i - 1]->counts && records[i].detector == records[i - 1].detector &&
            records[i].nearest == records[i - 1].nearest &&
            same_lap(*truths[i - 1]->scene, *truths[i]->scene) &&
            travel_m(*truths[i - 1]->scene, *truths[i]->scene) < kCentreLineLength_m) {
            all[i].score.steady = is_steady(lines[i - 1], lines[i]);
        }
        all[i].score.trained_on = courses.at(records[i].detector).contains(truths[i]->scene->track);
        if (records[i].answer.status == LaneStatus::none &&
            optimising.contains(key_of(*truths[i]->scene, records[i]).detector_label())) {
            all[i].score.solved_to_optimality = records[i].latency_ms <= kRldTimeLimit_ms;
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

void write_scores(std::ostream& output, std::span<const ScoredRecord> scored) {
    for (const ScoredRecord& record : scored) output << score_line(record).dump() << '\n';
}

void write_results(std::ostream& output, std::span<const ScoreRow> rows, std::span<const ScoredRecord> scored,
                   const OutsideDetectors& outside, const std::string& run) {
    const Provenance origin = provenance();
    for (const ScoreRow& row : rows) {
        nlohmann::ordered_json line = nlohmann::ordered_json::parse(summary_json(row));
        const auto detector = std::ranges::find(outside.detectors, row.key.detector, &OutsideDetector::name);
        if (detector != outside.detectors.end()) {
            const auto is_of_row = [&](const ScoredRecord& record) {
                return key_of(*record.scene, *record.record) == row.key;
            };
            line.update(outside_part(*detector, self_times_ms(scored, is_of_row), outside.echo));
        }
        line["commit"] = origin.commit;
        line["compiler"] = origin.compiler;
        line["machine"] = origin.machine;
        line["run"] = nlohmann::ordered_json::parse(run);
        output << line.dump() << '\n';
    }
}

std::string outside_notes(std::span<const ScoredRecord> scored, const OutsideDetectors& outside) {
    if (outside.detectors.empty()) return "";
    std::string notes = "methods from outside\n";
    for (const OutsideDetector& detector : outside.detectors) {
        const auto is_of_detector = [&](const ScoredRecord& record) {
            return record.record->detector == detector.name;
        };
        const std::vector<double> own_ms = self_times_ms(scored, is_of_detector);
        notes += "  " + detector.name + ": ";
        if (detector.is_program()) {
            notes += "latency is the round trip of a scene and its answer; ";
            notes += outside.echo.empty()
                         ? "that of an echo program is unknown"
                         : fmt::format("that of an echo program is {:.2f} ms (median), {:.2f} (p95)",
                                       median(outside.echo), quantile(outside.echo, 0.95));
            if (!own_ms.empty()) {
                notes += fmt::format("; self-timed {:.2f} ms (median), {:.2f} (p95)", median(own_ms),
                                     quantile(own_ms, 0.95));
            }
        } else if (detector.is_solver()) {
            notes +=
                fmt::format("RLD by a solver from outside, {} formulation; latency includes files and pipes",
                            to_string(detector.formulation.value_or(Formulation::tight)));
        } else {
            notes += "latency is self-timed, as the lanes file says";
        }
        notes += '\n';
        if (detector.card) notes += "    " + detector.card->summary() + '\n';
        notes += note_on_errors(scored, detector.name);
    }
    return notes;
}

}  // namespace conelane::experiments
