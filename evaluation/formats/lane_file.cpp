#include "evaluation/formats/lane_file.hpp"

#include "evaluation/formats/json_records.hpp"

namespace conelane {

template <>
struct Choices<LaneStatus> {
    static constexpr std::array all{LaneStatus::found, LaneStatus::none, LaneStatus::stopped,
                                    LaneStatus::error};
};

namespace {

using nlohmann::ordered_json;

/// How files of version 0.1 spell "stopped by time".
constexpr std::string_view kStoppedByTime = "time_limit";

struct AnswerStatus {
    static void read(const JsonNode& json, LaneRecord& record) {
        LaneAnswer& answer = record.answer;
        const JsonNode status = json.member("status");
        const bool by_time = status.string() == kStoppedByTime;
        answer.status = by_time ? LaneStatus::stopped : status.one_of(Choices<LaneStatus>::all);
        if (by_time) answer.stopped_by = StopReason::time;
    }
    static void put(ordered_json& json, const LaneRecord& record, const std::string& /*place*/) {
        json["status"] = to_string(record.answer.status);
    }
};

/// Absent if nothing is proven.
struct OptionalBound {
    static void read(const JsonNode& json, Optimality& optimality) {
        const auto bound = json.find("bound");
        optimality.bound = bound ? bound->number() : -std::numeric_limits<double>::infinity();
    }
    static void put(ordered_json& json, const Optimality& optimality, const std::string& place) {
        put_bound(json, optimality.bound, place + "bound");
    }
};

}  // namespace

template <>
inline constexpr std::tuple kFields<Lane>{Field{"left", &Lane::left}, Field{"right", &Lane::right},
                                          Field{"closed", &Lane::closed, Absent::when_read}};
template <>
inline constexpr std::tuple kFields<Optimality>{Field{"objective", &Optimality::objective}, OptionalBound{},
                                                Field{"optimal", &Optimality::optimal}};
template <>
inline constexpr std::tuple kFields<LaneCandidate>{
    Field{"left", kInside<&LaneCandidate::lane, &Lane::left>},
    Field{"right", kInside<&LaneCandidate::lane, &Lane::right>},
    Field{"closed", kInside<&LaneCandidate::lane, &Lane::closed>, Absent::if_empty},
    Field{"iteration", &LaneCandidate::iteration, Range::not_negative},
    Field{"confidence", &LaneCandidate::confidence, Range::share}};
template <>
inline constexpr std::tuple kFields<Enumeration>{
    Field{"iterations", &Enumeration::iterations, Range::not_negative},
    Field{"complete", &Enumeration::complete},
    Field{"candidates", &Enumeration::candidates, Absent::if_empty}};
template <>
inline constexpr std::tuple kFields<BoundaryPoints>{Field{"left_points", &BoundaryPoints::left},
                                                    Field{"right_points", &BoundaryPoints::right}};

namespace {

/// Boundaries by cone ids, or else by points, or else a centre line.
struct AnswerShape {
    bool may_be_absent;  ///< unless status is found

    void read(const JsonNode& json, LaneRecord& record) const {
        const bool found = record.answer.status == LaneStatus::found;
        const bool has_points = json.find("left_points") || json.find("right_points");
        const auto centre_line = json.find("centre_line");
        Lane& lane = record.answer.lane;
        const bool needs_cones = !has_points && !centre_line && (found || !may_be_absent);
        if (json.find("left") || json.find("right") || needs_cones) {
            read_fields(json, lane, kFields<Lane>);
        } else if (const auto closed = json.find("closed")) {
            lane.closed = closed->boolean();
        }
        if (lane.left.empty() && lane.right.empty()) {
            if (has_points) {
                read_fields(json, record.points.emplace(), kFields<BoundaryPoints>);
            } else if (centre_line) {
                read_value(*centre_line, record.centre_line);
            }
        }
        if (!found) require_empty(json, record);
    }
    static void put(ordered_json& json, const LaneRecord& record, const std::string& place) {
        put_fields(json, record.answer.lane, kFields<Lane>, place);
    }

  private:
    static void require_empty(const JsonNode& json, LaneRecord& record) {
        const BoundaryPoints points = record.points.value_or(BoundaryPoints{});
        for (const auto& [key, is_empty] : {std::pair{"left", record.answer.lane.left.empty()},
                                            {"right", record.answer.lane.right.empty()},
                                            {"left_points", points.left.empty()},
                                            {"right_points", points.right.empty()},
                                            {"centre_line", record.centre_line.empty()}}) {
            if (!is_empty)
                json.fail_in(key,
                             "must be empty if status is " + std::string(to_string(record.answer.status)));
        }
        record.points.reset();
    }
};

/// What AnswerShape has read.
struct AnswerPoints {
    static void read(const JsonNode& /*json*/, LaneRecord& /*record*/) {}
    static void put(ordered_json& json, const LaneRecord& record, const std::string& place) {
        if (record.points) put_fields(json, *record.points, kFields<BoundaryPoints>, place);
        if (!record.centre_line.empty())
            json["centre_line"] = value_json(record.centre_line, place + "centre_line");
    }
};

}  // namespace

/// What detectors from outside may say too.
template <>
inline constexpr std::tuple kFields<LaneAnswer>{
    Field{"stopped_by", &LaneAnswer::stopped_by}, Field{"message", &LaneAnswer::message, Absent::if_empty},
    Field{"confidence", &LaneAnswer::confidence, Range::share},
    Field{"trusted_m", &LaneAnswer::trusted_m, Range::not_negative}};

template <>
inline constexpr std::tuple kFields<LaneRecord>{
    Field{"scene", &LaneRecord::scene},
    Field{"method", &LaneRecord::detector},
    AnswerStatus{},
    AnswerShape{.may_be_absent = false},
    Field{"latency_ms", &LaneRecord::latency_ms, Range::not_negative},
    AnswerPoints{},
    Field{"self_timed_ms", &LaneRecord::self_timed_ms, Range::not_negative},
    Inlined{&LaneRecord::answer},
    Inlined{kInside<&LaneRecord::answer, &LaneAnswer::optimality>, "objective"},
    Inlined{kInside<&LaneRecord::answer, &LaneAnswer::enumeration>, "iterations"},
    Field{"nearest", &LaneRecord::nearest},
    Field{"checked", &LaneRecord::checked, Absent::if_empty}};

namespace {

constexpr std::tuple kForeign{Field{"scene", &LaneRecord::scene}, AnswerStatus{},
                              AnswerShape{.may_be_absent = true}, Inlined{&LaneRecord::answer},
                              Field{"latency_ms", &LaneRecord::self_timed_ms, Range::not_negative}};

LaneRecord read_foreign(const JsonNode& json) {
    LaneRecord record;
    record.line = json.line();
    read_fields(json, record, kForeign);
    return record;
}

}  // namespace

std::vector<LaneRecord> read_lanes(const std::filesystem::path& file) {
    FirstLines<std::tuple<std::string, std::string, std::optional<std::size_t>>> answers;
    return read_records<LaneRecord>(file, [&](const JsonNode& json, const LaneRecord& record) {
        answers.require_new(
            {record.scene, record.detector, record.nearest}, json, "scene",
            "method \"" + record.detector + "\" answers scene \"" + record.scene + "\" twice");
    });
}

LaneRecord read_foreign_lane(std::string_view line) {
    LaneRecord record;
    with_json_line(line, "", 0, [&](const JsonNode& json) { record = read_foreign(json); });
    return record;
}

std::vector<LaneRecord> read_foreign_lanes(const std::filesystem::path& file) {
    std::vector<LaneRecord> records;
    FirstLines<std::string> answers;
    for_each_json_line(file, [&](const JsonNode& json) {
        const LaneRecord& record = records.emplace_back(read_foreign(json));
        (void)json.member("latency_ms");
        answers.require_new(record.scene, json, "scene", "scene \"" + record.scene + "\" is answered twice");
    });
    return records;
}

void write_lanes(const std::filesystem::path& file, std::span<const LaneRecord> records) {
    write_records(file, records, "lanes");
}

std::string lane_line(const LaneRecord& record) {
    return to_line(value_json(record, "lane"));
}

}  // namespace conelane
