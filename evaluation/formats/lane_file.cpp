#include "evaluation/formats/lane_file.hpp"

#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/json_node.hpp"
#include "evaluation/input_error.hpp"

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <string_view>
#include <tuple>
#include <utility>

namespace conelane {
namespace {

using nlohmann::ordered_json;

constexpr std::array kStatuses{LaneStatus::found, LaneStatus::none, LaneStatus::stopped, LaneStatus::error};
/// How files of version 0.1 spell "stopped by time".
constexpr std::string_view kStoppedByTime = "time_limit";
constexpr std::array kStopReasons{StopReason::time, StopReason::iterations, StopReason::memory};

std::vector<ConeId> read_ids(const JsonNode& json) {
    std::vector<ConeId> ids;
    const std::size_t size = json.array_size();
    ids.reserve(size);
    for (std::size_t i = 0; i < size; ++i) ids.push_back(json.element(i).integer());
    return ids;
}

Lane read_lane(const JsonNode& json) {
    Lane lane{read_ids(json.member("left")), read_ids(json.member("right"))};
    if (const auto closed = json.find("closed")) lane.closed = closed->boolean();
    return lane;
}

Optimality read_optimality(const JsonNode& json) {
    const auto bound = json.find("bound");
    return {json.member("objective").number(),
            bound ? bound->number() : -std::numeric_limits<double>::infinity(),
            json.member("optimal").boolean()};
}

Enumeration read_enumeration(const JsonNode& json) {
    Enumeration enumeration{
        json.member("iterations").non_negative_integer(), json.member("complete").boolean(), {}};
    if (const auto candidates = json.find("candidates")) {
        const std::size_t size = candidates->array_size();
        for (std::size_t i = 0; i < size; ++i) {
            const JsonNode candidate = candidates->element(i);
            LaneCandidate& read = enumeration.candidates.emplace_back(
                LaneCandidate{read_lane(candidate), candidate.member("iteration").non_negative_integer()});
            if (const auto confidence = candidate.find("confidence"))
                read.confidence = confidence->number_in(0.0, 1.0);
        }
    }
    return enumeration;
}

std::vector<Point> read_points(const JsonNode& json) {
    std::vector<Point> points;
    const std::size_t size = json.array_size();
    points.reserve(size);
    for (std::size_t i = 0; i < size; ++i) {
        const JsonNode point = json.element(i);
        if (point.array_size() != 2) point.fail("must be [x, y]");
        points.emplace_back(point.element(0).number(), point.element(1).number());
    }
    return points;
}

/// Boundaries by cone ids, or else by points, or else a centre line.
void read_shape(const JsonNode& json, bool may_be_absent, LaneRecord& record) {
    const auto left_points = json.find("left_points");
    const auto right_points = json.find("right_points");
    const auto centre_line = json.find("centre_line");
    const bool has_points = left_points || right_points;
    Lane& lane = record.answer.lane;
    if (json.find("left") || json.find("right") || !(has_points || centre_line || may_be_absent)) {
        lane = read_lane(json);
    } else if (const auto closed = json.find("closed")) {
        lane.closed = closed->boolean();
    }
    if (!lane.left.empty() || !lane.right.empty()) return;
    if (has_points) {
        record.points = {read_points(json.member("left_points")), read_points(json.member("right_points"))};
    } else if (centre_line) {
        record.centre_line = read_points(*centre_line);
    }
}

void read_answer(const JsonNode& json, bool may_be_without_shape, LaneRecord& record) {
    LaneAnswer& answer = record.answer;
    if (json.member("status").string() == kStoppedByTime) {
        answer.status = LaneStatus::stopped;
        answer.stopped_by = StopReason::time;
    } else {
        answer.status = json.member("status").one_of(kStatuses);
    }
    if (const auto reason = json.find("stopped_by")) answer.stopped_by = reason->one_of(kStopReasons);
    const bool found = answer.status == LaneStatus::found;
    read_shape(json, !found && may_be_without_shape, record);
    if (!found) {
        const std::string reason = "must be empty if status is " + std::string(to_string(answer.status));
        if (!answer.lane.left.empty()) json.member("left").fail(reason);
        if (!answer.lane.right.empty()) json.member("right").fail(reason);
        if (record.points && !record.points->left.empty()) json.member("left_points").fail(reason);
        if (record.points && !record.points->right.empty()) json.member("right_points").fail(reason);
        if (!record.centre_line.empty()) json.member("centre_line").fail(reason);
        record.points.reset();
    }
    if (const auto message = json.find("message")) answer.message = message->string();
    if (const auto confidence = json.find("confidence")) answer.confidence = confidence->number_in(0.0, 1.0);
    if (const auto trusted = json.find("trusted_m")) answer.trusted_m = trusted->non_negative_number();
}

LaneRecord read_record(const JsonNode& json) {
    LaneRecord record;
    record.line = json.line();
    record.scene = json.member("scene").string();
    record.detector = json.member("method").string();
    read_answer(json, false, record);
    record.latency_ms = json.member("latency_ms").non_negative_number();
    if (const auto own = json.find("self_timed_ms")) record.self_timed_ms = own->non_negative_number();
    LaneAnswer& answer = record.answer;
    if (json.find("objective")) answer.optimality = read_optimality(json);
    if (json.find("iterations")) answer.enumeration = read_enumeration(json);
    if (const auto nearest = json.find("nearest")) {
        record.nearest = static_cast<std::size_t>(nearest->non_negative_integer());
    }
    if (const auto checked = json.find("checked")) record.checked = checked->boolean();
    return record;
}

LaneRecord read_foreign(const JsonNode& json) {
    LaneRecord record;
    record.line = json.line();
    record.scene = json.member("scene").string();
    read_answer(json, true, record);
    if (const auto own = json.find("latency_ms")) record.self_timed_ms = own->non_negative_number();
    return record;
}

ordered_json to_json(const std::vector<Point>& points, const std::string& key) {
    ordered_json json = ordered_json::array();
    for (const Point& point : points) {
        json.push_back(ordered_json::array({require_finite(point.x(), key), require_finite(point.y(), key)}));
    }
    return json;
}

ordered_json to_json(const LaneRecord& record, const std::string& key) {
    const LaneAnswer& answer = record.answer;
    ordered_json json{{"scene", record.scene},
                      {"method", record.detector},
                      {"status", to_string(answer.status)},
                      {"left", answer.lane.left},
                      {"right", answer.lane.right},
                      {"closed", answer.lane.closed},
                      {"latency_ms", require_finite(record.latency_ms, key + "latency_ms")}};
    if (record.points) {
        json["left_points"] = to_json(record.points->left, key + "left_points");
        json["right_points"] = to_json(record.points->right, key + "right_points");
    }
    if (!record.centre_line.empty()) json["centre_line"] = to_json(record.centre_line, key + "centre_line");
    if (record.self_timed_ms)
        json["self_timed_ms"] = require_finite(*record.self_timed_ms, key + "self_timed_ms");
    if (answer.stopped_by) json["stopped_by"] = to_string(*answer.stopped_by);
    if (!answer.message.empty()) json["message"] = answer.message;
    if (answer.confidence) json["confidence"] = require_finite(*answer.confidence, key + "confidence");
    if (answer.trusted_m) json["trusted_m"] = require_finite(*answer.trusted_m, key + "trusted_m");
    if (const auto& optimality = answer.optimality) {
        json["objective"] = require_finite(optimality->objective, key + "objective");
        put_bound(json, optimality->bound, key + "bound");
        json["optimal"] = optimality->optimal;
    }
    if (const auto& enumeration = answer.enumeration) {
        json["iterations"] = enumeration->iterations;
        json["complete"] = enumeration->complete;
        if (!enumeration->candidates.empty()) {
            ordered_json& candidates = json["candidates"] = ordered_json::array();
            for (const auto& [lane, iteration, confidence] : enumeration->candidates) {
                ordered_json candidate{{"left", lane.left}, {"right", lane.right}};
                if (lane.closed) candidate["closed"] = true;
                candidate["iteration"] = iteration;
                if (confidence) candidate["confidence"] = require_finite(*confidence, key + "candidates");
                candidates.push_back(std::move(candidate));
            }
        }
    }
    if (record.nearest) json["nearest"] = *record.nearest;
    if (record.checked) json["checked"] = true;
    return json;
}

}  // namespace

std::vector<LaneRecord> read_lanes(const std::filesystem::path& file) {
    std::vector<LaneRecord> records;
    std::map<std::tuple<std::string, std::string, std::optional<std::size_t>>, std::size_t> line_of;
    for_each_json_line(file, [&](const JsonNode& json) {
        LaneRecord record = read_record(json);
        const auto [first, is_new] =
            line_of.try_emplace({record.scene, record.detector, record.nearest}, json.line());
        if (!is_new) {
            json.member("scene").fail("method \"" + record.detector + "\" answers scene \"" + record.scene +
                                      "\" twice, first on line " + std::to_string(first->second));
        }
        records.push_back(std::move(record));
    });
    return records;
}

LaneRecord read_foreign_lane(std::string_view line) {
    LaneRecord record;
    with_json_line(line, "", 0, [&](const JsonNode& json) { record = read_foreign(json); });
    return record;
}

std::vector<LaneRecord> read_foreign_lanes(const std::filesystem::path& file) {
    std::vector<LaneRecord> records;
    std::map<std::string, std::size_t> line_of;
    for_each_json_line(file, [&](const JsonNode& json) {
        LaneRecord record = read_foreign(json);
        (void)json.member("latency_ms");
        const auto [first, is_new] = line_of.try_emplace(record.scene, json.line());
        if (!is_new) {
            json.member("scene").fail("scene \"" + record.scene + "\" is answered twice, first on line " +
                                      std::to_string(first->second));
        }
        records.push_back(std::move(record));
    });
    return records;
}

void write_lanes(const std::filesystem::path& file, std::span<const LaneRecord> records) {
    AtomicFile output(file);
    for (std::size_t i = 0; i < records.size(); ++i) {
        output.stream() << to_line(to_json(records[i], "lanes[" + std::to_string(i) + "].")) << '\n';
    }
    output.commit();
}

std::string lane_line(const LaneRecord& record) {
    return to_line(to_json(record, ""));
}

}  // namespace conelane
