#include "experiments/files/lane_file.hpp"

#include "experiments/files/atomic_file.hpp"
#include "experiments/files/input_error.hpp"
#include "experiments/files/json_node.hpp"

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <string_view>
#include <tuple>
#include <utility>

namespace conelane::experiments {
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
            enumeration.candidates.push_back(
                {read_lane(candidate), candidate.member("iteration").non_negative_integer()});
        }
    }
    return enumeration;
}

LaneRecord read_record(const JsonNode& json) {
    LaneRecord record;
    record.line = json.line();
    record.scene = json.member("scene").string();
    record.method = json.member("method").string();
    LaneAnswer& answer = record.answer;
    if (json.member("status").string() == kStoppedByTime) {
        answer.status = LaneStatus::stopped;
        answer.stopped_by = StopReason::time;
    } else {
        answer.status = json.member("status").one_of(kStatuses);
    }
    if (const auto reason = json.find("stopped_by")) answer.stopped_by = reason->one_of(kStopReasons);
    answer.lane = read_lane(json);
    if (answer.status != LaneStatus::found) {
        const std::string reason = "must be empty where status is " + std::string(to_string(answer.status));
        if (!answer.lane.left.empty()) json.member("left").fail(reason);
        if (!answer.lane.right.empty()) json.member("right").fail(reason);
    }
    record.latency_ms = json.member("latency_ms").non_negative_number();
    if (const auto message = json.find("message")) answer.message = message->string();
    if (const auto confidence = json.find("confidence")) answer.confidence = confidence->number_in(0.0, 1.0);
    if (const auto trusted = json.find("trusted_m")) answer.trusted_m = trusted->non_negative_number();
    if (json.find("objective")) answer.optimality = read_optimality(json);
    if (json.find("iterations")) answer.enumeration = read_enumeration(json);
    if (const auto nearest = json.find("nearest")) {
        record.nearest = static_cast<std::size_t>(nearest->non_negative_integer());
    }
    if (const auto checked = json.find("checked")) record.checked = checked->boolean();
    return record;
}

ordered_json to_json(const LaneRecord& record, const std::string& key) {
    const LaneAnswer& answer = record.answer;
    ordered_json json{{"scene", record.scene},
                      {"method", record.method},
                      {"status", to_string(answer.status)},
                      {"left", answer.lane.left},
                      {"right", answer.lane.right},
                      {"closed", answer.lane.closed},
                      {"latency_ms", require_finite(record.latency_ms, key + "latency_ms")}};
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
            for (const auto& [lane, iteration] : enumeration->candidates) {
                ordered_json candidate{{"left", lane.left}, {"right", lane.right}};
                if (lane.closed) candidate["closed"] = true;
                candidate["iteration"] = iteration;
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
            line_of.try_emplace({record.scene, record.method, record.nearest}, json.line());
        if (!is_new) {
            json.member("scene").fail("method \"" + record.method + "\" answers scene \"" + record.scene +
                                      "\" twice, first on line " + std::to_string(first->second));
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

}  // namespace conelane::experiments
