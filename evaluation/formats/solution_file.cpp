#include "evaluation/formats/solution_file.hpp"

#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/json_node.hpp"

#include <array>
#include <map>
#include <string_view>
#include <tuple>

namespace conelane {
namespace {

using nlohmann::ordered_json;

constexpr std::array<std::string_view, 5> kStatuses{"optimal", "feasible", "infeasible", "stopped", "error"};
/// The word for "stopped" in files of version 0.5 and earlier, for every limit.
constexpr std::string_view kStopped = kStatuses[3];
constexpr std::string_view kOldStopped = "time_limit";
constexpr std::array kStopReasons{StopReason::time, StopReason::iterations, StopReason::memory};

std::vector<std::pair<ConeId, ConeId>> read_edges(const JsonNode& json) {
    std::vector<std::pair<ConeId, ConeId>> edges;
    const std::size_t size = json.array_size();
    edges.reserve(size);
    for (std::size_t i = 0; i < size; ++i) {
        const JsonNode edge = json.element(i);
        if (edge.array_size() != 2) edge.fail("must be a pair of cone ids");
        edges.emplace_back(edge.element(0).integer(), edge.element(1).integer());
    }
    return edges;
}

SolutionRecord read_record(const JsonNode& json) {
    SolutionRecord record;
    record.line = json.line();
    record.scene = json.member("scene").string();
    record.solver = json.member("solver").string();
    record.formulation = json.member("formulation").string();
    const JsonNode status = json.member("status");
    record.status = status.string() == kOldStopped ? kStopped : kStatuses[status.index_in(kStatuses)];
    record.edges = read_edges(json.member("edges"));
    if (!record.edges.empty() && record.status != "optimal" && record.status != "feasible") {
        json.member("edges").fail("must be empty if status is " + record.status);
    }
    if (const auto message = json.find("message")) record.message = message->string();
    if (const auto objective = json.find("objective")) record.objective = objective->number();
    if (const auto bound = json.find("bound")) record.bound = bound->number();
    if (const auto nodes = json.find("nodes")) record.nodes = nodes->non_negative_integer();
    record.build_ms = json.member("build_ms").non_negative_number();
    record.solve_ms = json.member("solve_ms").non_negative_number();
    if (const auto reason = json.find("stopped_by")) record.stopped_by = reason->one_of(kStopReasons);
    if (const auto nearest = json.find("nearest")) {
        record.nearest = static_cast<std::size_t>(nearest->non_negative_integer());
    }
    record.parameters = read_parameter_tag(json);
    return record;
}

ordered_json to_json(const SolutionRecord& record, const std::string& key) {
    ordered_json edges = ordered_json::array();
    for (const auto& [i, j] : record.edges) edges.push_back(ordered_json::array({i, j}));
    ordered_json json{{"scene", record.scene},
                      {"solver", record.solver},
                      {"formulation", record.formulation},
                      {"status", record.status},
                      {"edges", std::move(edges)}};
    if (record.objective) json["objective"] = require_finite(*record.objective, key + "objective");
    if (record.bound) put_bound(json, *record.bound, key + "bound");
    if (record.nodes) json["nodes"] = *record.nodes;
    json["build_ms"] = require_finite(record.build_ms, key + "build_ms");
    json["solve_ms"] = require_finite(record.solve_ms, key + "solve_ms");
    if (record.stopped_by) json["stopped_by"] = to_string(*record.stopped_by);
    if (record.nearest) json["nearest"] = *record.nearest;
    put_parameter_tag(json, record.parameters);
    if (!record.message.empty()) json["message"] = record.message;
    return json;
}

}  // namespace

std::vector<SolutionRecord> read_solutions(const std::filesystem::path& file) {
    std::vector<SolutionRecord> records;
    std::map<std::tuple<std::string, std::string, std::string>, std::size_t> line_of;
    for_each_json_line(file, [&](const JsonNode& json) {
        SolutionRecord record = read_record(json);
        const auto [first, is_new] =
            line_of.try_emplace({record.scene, record.solver, record.formulation}, json.line());
        if (!is_new) {
            json.member("scene").fail("solver \"" + record.solver + "\" answers scene \"" + record.scene +
                                      "\" twice with one formulation, first on line " +
                                      std::to_string(first->second));
        }
        records.push_back(std::move(record));
    });
    return records;
}

void write_solutions(const std::filesystem::path& file, std::span<const SolutionRecord> records) {
    AtomicFile output(file);
    for (std::size_t i = 0; i < records.size(); ++i) {
        output.stream() << to_line(to_json(records[i], "solutions[" + std::to_string(i) + "].")) << '\n';
    }
    output.commit();
}

}  // namespace conelane
