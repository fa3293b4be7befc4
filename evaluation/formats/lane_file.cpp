#include "evaluation/formats/lane_file.hpp"

#include "evaluation/formats/json_records.hpp"

#include <fmt/format.h>

namespace conelane {
namespace {

using nlohmann::ordered_json;

/// Adds `trusted_m` and `inferred` if they are known, `bridged` and `points` to an object.
void put_drivable_lane(ordered_json& json, const DrivableLane& lane) {
    if (lane.trusted_m) json["trusted_m"] = *lane.trusted_m;
    if (lane.left_inferred || lane.right_inferred) json["inferred"] = lane.left_inferred ? "left" : "right";
    ordered_json& bridged = json["bridged"] = ordered_json::array();
    for (const BridgedGap& gap : lane.bridged) {
        bridged.push_back(
            {{"side", gap.on_left ? "left" : "right"}, {"from_s_m", gap.from_s_m}, {"to_s_m", gap.to_s_m}});
    }
    ordered_json& points = json["points"] = ordered_json::array();
    for (const DrivablePoint& point : lane.points) {
        points.push_back({{"s_m", point.s_m},
                          {"x_m", point.position.x()},
                          {"y_m", point.position.y()},
                          {"heading_rad", point.heading_rad},
                          {"curvature_1pm", point.curvature_1pm},
                          {"width_left_m", point.width_left_m},
                          {"width_right_m", point.width_right_m}});
    }
}

ordered_json to_json(const DrivableRecord& record) {
    const DrivableLane& lane = record.lane;
    ordered_json json{{"scene", record.scene},
                      {"method", record.detector},
                      {"status", to_string(record.status)},
                      {"closed", lane.closed},
                      {"length_m", lane.length_m}};
    put_drivable_lane(json, lane);
    return json;
}

template <typename Columns>
void write_csv(const std::filesystem::path& file, const DrivableLane& lane, const char* head,
               const Columns& columns) {
    AtomicFile output(file);
    output.stream() << head << '\n';
    for (const DrivablePoint& point : lane.points) {
        const auto [a, b, c, d] = columns(point);
        output.stream() << fmt::format("{:.6f},{:.6f},{:.6f},{:.6f}\n", a, b, c, d);
    }
    output.commit();
}

}  // namespace

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
    Field{"nearest", &LaneRecord::nearest, Range::positive},
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

void write_drivable_lanes(const std::filesystem::path& file, std::span<const DrivableRecord> records) {
    AtomicFile output(file);
    for (const DrivableRecord& record : records) output.stream() << to_line(to_json(record)) << '\n';
    output.commit();
}

void write_tum_csv(const std::filesystem::path& file, const DrivableLane& lane) {
    write_csv(file, lane, "# x_m,y_m,w_tr_right_m,w_tr_left_m", [](const DrivablePoint& point) {
        return std::array{point.position.x(), point.position.y(), point.width_right_m, point.width_left_m};
    });
}

void write_ft_fsd_csv(const std::filesystem::path& file, const DrivableLane& lane) {
    write_csv(file, lane, "# s_m,x_m,y_m,curvature_1pm", [](const DrivablePoint& point) {
        return std::array{point.s_m, point.position.x(), point.position.y(), point.curvature_1pm};
    });
}

std::string plan_line(std::size_t frame, double time_s, const Plan& plan) {
    ordered_json json{{"frame", frame},       {"time_s", time_s},  {"state", to_string(plan.state)},
                      {"lap", plan.lap},      {"stop", plan.stop}, {"age_s", plan.age_s},
                      {"safe_m", plan.safe_m}};
    if (!plan.phase.empty()) json["phase"] = plan.phase;
    if (!plan.reason.empty()) json["reason"] = plan.reason;
    if (plan.stop_line_m) json["stop_line_m"] = *plan.stop_line_m;
    ordered_json answer{{"status", to_string(plan.answer.status)}};
    if (plan.answer.stopped_by) answer["stopped_by"] = to_string(*plan.answer.stopped_by);
    if (!plan.answer.message.empty()) answer["message"] = plan.answer.message;
    if (plan.answer.confidence) answer["confidence"] = *plan.answer.confidence;
    json["answer"] = std::move(answer);
    json["length_m"] = plan.lane.length_m;
    put_drivable_lane(json, plan.lane);
    return to_line(json);
}

std::string refused_frame_line(std::size_t frame, const std::string& message) {
    return to_line(ordered_json{{"frame", frame}, {"error", message}});
}

}  // namespace conelane
