#include "evaluation/formats/solution_file.hpp"

#include "evaluation/formats/json_records.hpp"

namespace conelane {
namespace {

/// A status, and then the edges that it allows.
struct StatusAndEdges {
    static constexpr std::array<std::string_view, 5> kStatuses{"optimal", "feasible", "infeasible", "stopped",
                                                               "error"};
    /// The word for "stopped" in files of version 0.5 and earlier, for every limit.
    static constexpr std::string_view kOldStopped = "time_limit";

    static void read(const JsonNode& json, SolutionRecord& record) {
        const JsonNode status = json.member("status");
        record.status = status.string() == kOldStopped ? "stopped" : kStatuses[status.index_in(kStatuses)];
        read_value(json.member("edges"), record.edges);
        if (!record.edges.empty() && record.status != "optimal" && record.status != "feasible")
            json.fail_in("edges", "must be empty if status is " + record.status);
    }
    static void put(nlohmann::ordered_json& json, const SolutionRecord& record, const std::string& place) {
        json["status"] = record.status;
        json["edges"] = value_json(record.edges, place + "edges");
    }
};

/// A bound of minus infinity is left out.
struct ProvenBound {
    static void read(const JsonNode& json, SolutionRecord& record) {
        if (const auto bound = json.find("bound")) record.bound = bound->number();
    }
    static void put(nlohmann::ordered_json& json, const SolutionRecord& record, const std::string& place) {
        if (record.bound) put_bound(json, *record.bound, place + "bound");
    }
};

}  // namespace

template <>
inline constexpr std::tuple kFields<SolutionRecord>{
    Field{"scene", &SolutionRecord::scene},
    Field{"solver", &SolutionRecord::solver},
    Field{"formulation", &SolutionRecord::formulation},
    StatusAndEdges{},
    Field{"objective", &SolutionRecord::objective},
    ProvenBound{},
    Field{"nodes", &SolutionRecord::nodes, Range::not_negative},
    Field{"build_ms", &SolutionRecord::build_ms, Range::not_negative},
    Field{"solve_ms", &SolutionRecord::solve_ms, Range::not_negative},
    Field{"stopped_by", &SolutionRecord::stopped_by},
    Field{"nearest", &SolutionRecord::nearest},
    Inlined{&SolutionRecord::parameters},
    Field{"message", &SolutionRecord::message, Absent::if_empty}};

std::vector<SolutionRecord> read_solutions(const std::filesystem::path& file) {
    FirstLines<std::tuple<std::string, std::string, std::string>> answers;
    return read_records<SolutionRecord>(file, [&](const JsonNode& json, const SolutionRecord& record) {
        answers.require_new({record.scene, record.solver, record.formulation}, json, "scene",
                            "solver \"" + record.solver + "\" answers scene \"" + record.scene +
                                "\" twice with one formulation");
    });
}

void write_solutions(const std::filesystem::path& file, std::span<const SolutionRecord> records) {
    write_records(file, records, "solutions");
}

}  // namespace conelane
