#include "evaluation/formats/solution_file.hpp"

#include "evaluation/formats/json_records.hpp"

#include <unordered_map>

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

using Record = SearchCertificateRecord;

/// `bound`, or `infeasible` if it is infinite.
struct ClaimedBound {
    static constexpr double kInfinity = std::numeric_limits<double>::infinity();

    static void read(const JsonNode& json, CertificateClaim& claim) {
        const auto bound = json.find("bound");
        const auto infeasible = json.find("infeasible");
        if (bound) claim.bound = bound->number();
        if (!infeasible || !infeasible->boolean()) return;
        if (bound) bound->fail("must be left out if the scene is called infeasible");
        claim.bound = kInfinity;
    }
    static void put(nlohmann::ordered_json& json, const CertificateClaim& claim, const std::string& place) {
        if (claim.bound != kInfinity) return put_bound(json, claim.bound, place + "bound");
        json["infeasible"] = true;
    }
};

constexpr std::tuple kClaim{Field{"scene", &CertificateClaim::scene},
                            Field{"nearest", &CertificateClaim::nearest, Range::positive},
                            Inlined{&CertificateClaim::parameters}};

/// Indices of a scene's cones, and the first id that has none.
class Indices {
  public:
    explicit Indices(const Scene& scene) {
        for (std::size_t i = 0; i < scene.cones.size(); ++i) index_of_.emplace(scene.cones[i].id, i);
    }
    std::size_t operator()(ConeId id) {
        const auto found = index_of_.find(id);
        if (found != index_of_.end()) return found->second;
        if (!missing) missing = id;
        return 0;
    }
    std::vector<Edge> operator()(const std::vector<Record::EdgeById>& edges) {
        std::vector<Edge> indices;
        for (const auto& [a, b] : edges) indices.push_back(make_edge((*this)(a), (*this)(b)));
        return indices;
    }
    std::optional<ConeId> missing;

  private:
    std::unordered_map<ConeId, std::size_t> index_of_;
};

std::vector<Record::EdgeById> by_id(const Scene& scene, const std::vector<Edge>& edges) {
    std::vector<Record::EdgeById> ids;
    for (const Edge& edge : edges) ids.emplace_back(scene.cones[edge.i].id, scene.cones[edge.j].id);
    return ids;
}

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
    Field{"nearest", &SolutionRecord::nearest, Range::positive},
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

template <>
inline constexpr std::tuple kFields<CertificateRecord::Clique>{
    Field{"price", &CertificateRecord::Clique::multiplier},
    Field{"edges", &CertificateRecord::Clique::edges}};
template <>
inline constexpr std::tuple kFields<CertificateRecord> = std::tuple_cat(
    kClaim, std::tuple{ClaimedBound{}, Field{"heading_price", &CertificateRecord::heading_multiplier},
                       Field{"cone_prices", &CertificateRecord::cone_multipliers},
                       Field{"cliques", &CertificateRecord::cliques}});

template <>
inline constexpr std::tuple kFields<Record::Stage>{Field{"heading", &Record::Stage::heading},
                                                   Field{"cones", &Record::Stage::cones},
                                                   Field{"cliques", &Record::Stage::cliques}};
template <>
inline constexpr std::tuple kFields<Record::Part>{Field{"far_start", &Record::Part::far_start},
                                                  Field{"cliques", &Record::Part::cliques},
                                                  Field{"stages", &Record::Part::stages}};
template <>
inline constexpr std::tuple kFields<Record> =
    std::tuple_cat(kClaim, std::tuple{Field{"edges", &Record::edges}, Field{"objective", &Record::objective},
                                      ClaimedBound{}, Field{"parts", &Record::parts}});

SearchCertificateRecord to_search_record(const Scene& scene, const SearchCertificate& certificate) {
    Record record;
    record.scene = scene.id;
    if (certificate.lane_graph) record.edges = by_id(scene, certificate.lane_graph->edges);
    record.objective = certificate.objective;
    record.bound = certificate.bound;
    for (const SearchCertificate::Part& part : certificate.parts) {
        Record::Part& listed = record.parts.emplace_back();
        if (part.far_start) listed.far_start = scene.cones[*part.far_start].id;
        for (const auto& clique : part.cliques) listed.cliques.push_back(by_id(scene, clique));
        for (const SearchCertificate::Stage& stage : part.stages) {
            Record::Stage& listed_stage = listed.stages.emplace_back();
            listed_stage.heading = stage.heading;
            listed_stage.cliques = stage.clique;
            for (std::size_t i = 0; i < stage.cone.size(); ++i) {
                if (stage.cone[i] != 0) listed_stage.cones.emplace_back(scene.cones[i].id, stage.cone[i]);
            }
        }
    }
    return record;
}

std::optional<SearchCertificate> from_search_record(const Scene& scene, const SearchCertificateRecord& record,
                                                    ConeId& missing) {
    Indices index(scene);
    SearchCertificate certificate;
    if (record.edges) certificate.lane_graph = LaneGraph{index(*record.edges)};
    certificate.objective = record.objective;
    certificate.bound = record.bound;
    for (const Record::Part& listed : record.parts) {
        SearchCertificate::Part& part = certificate.parts.emplace_back();
        if (listed.far_start) part.far_start = index(*listed.far_start);
        for (const auto& clique : listed.cliques) part.cliques.push_back(index(clique));
        for (const Record::Stage& listed_stage : listed.stages) {
            SearchCertificate::Stage& stage = part.stages.emplace_back();
            stage.heading = listed_stage.heading;
            stage.clique = listed_stage.cliques;
            stage.cone.assign(scene.cones.size(), 0);
            for (const auto& [id, units] : listed_stage.cones) {
                const std::size_t cone = index(id);
                if (!index.missing) stage.cone[cone] = units;
            }
        }
    }
    if (!index.missing) return certificate;
    missing = *index.missing;
    return std::nullopt;
}

bool holds_search_certificates(const std::filesystem::path& file) {
    std::ifstream stream(file);
    std::string line;
    std::getline(stream, line);
    constexpr bool kThrows = false;
    const nlohmann::json first = nlohmann::json::parse(line, nullptr, kThrows);
    return first.is_object() && first.contains("parts");
}

std::vector<CertificateRecord> read_certificates(const std::filesystem::path& file) {
    return read_records<CertificateRecord>(file);
}

std::vector<SearchCertificateRecord> read_search_certificates(const std::filesystem::path& file) {
    return read_records<Record>(file);
}

void write_certificates(const std::filesystem::path& file, std::span<const CertificateRecord> records) {
    write_records(file, records, "certificates");
}

void write_search_certificates(const std::filesystem::path& file, std::span<const Record> records) {
    write_records(file, records, "certificates");
}

}  // namespace conelane
