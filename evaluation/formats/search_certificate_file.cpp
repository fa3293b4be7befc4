#include "evaluation/formats/search_certificate_file.hpp"

#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/json_node.hpp"

#include <fstream>
#include <limits>
#include <string>
#include <unordered_map>

namespace conelane {
namespace {

using nlohmann::ordered_json;
using Record = SearchCertificateRecord;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A list of pairs; `what` names them in the message.
template <typename Read>
void for_each_pair(const JsonNode& json, const std::string& what, const Read& read) {
    for (std::size_t k = 0; k < json.array_size(); ++k) {
        const JsonNode pair = json.element(k);
        if (pair.array_size() != 2) pair.fail("must be a pair of " + what);
        read(pair.element(0), pair.element(1));
    }
}

std::vector<Record::EdgeById> read_edges(const JsonNode& json) {
    std::vector<Record::EdgeById> edges;
    for_each_pair(json, "cone ids", [&](const JsonNode& first, const JsonNode& second) {
        edges.emplace_back(first.integer(), second.integer());
    });
    return edges;
}

Record::Stage read_stage(const JsonNode& json) {
    Record::Stage stage;
    stage.heading = json.member("heading").integer();
    for_each_pair(json.member("cones"), "cone id and multiplier",
                  [&](const JsonNode& cone, const JsonNode& units) {
                      stage.cones.emplace_back(cone.integer(), units.integer());
                  });
    for_each_pair(json.member("cliques"), "place and multiplier",
                  [&](const JsonNode& place, const JsonNode& units) {
                      stage.cliques.emplace_back(static_cast<std::size_t>(place.non_negative_integer()),
                                                 units.integer());
                  });
    return stage;
}

Record::Part read_part(const JsonNode& json) {
    Record::Part part;
    if (const auto far_start = json.find("far_start")) part.far_start = far_start->integer();
    const JsonNode cliques = json.member("cliques");
    for (std::size_t k = 0; k < cliques.array_size(); ++k)
        part.cliques.push_back(read_edges(cliques.element(k)));
    const JsonNode stages = json.member("stages");
    for (std::size_t k = 0; k < stages.array_size(); ++k)
        part.stages.push_back(read_stage(stages.element(k)));
    return part;
}

Record read_record(const JsonNode& json) {
    Record record;
    record.line = json.line();
    record.scene = json.member("scene").string();
    if (const auto nearest = json.find("nearest")) {
        record.nearest = static_cast<std::size_t>(nearest->non_negative_integer());
    }
    record.parameters = read_parameter_tag(json);
    if (const auto edges = json.find("edges")) record.edges = read_edges(*edges);
    if (const auto objective = json.find("objective")) record.objective = objective->number();
    const auto bound = json.find("bound");
    const auto infeasible = json.find("infeasible");
    record.bound = bound ? bound->number() : -kInfinity;
    if (infeasible && infeasible->boolean()) {
        if (bound) bound->fail("must be left out if the scene is called infeasible");
        record.bound = kInfinity;
    }
    const JsonNode parts = json.member("parts");
    for (std::size_t k = 0; k < parts.array_size(); ++k) record.parts.push_back(read_part(parts.element(k)));
    return record;
}

template <typename Pairs>
ordered_json pairs_to_json(const Pairs& pairs) {
    ordered_json json = ordered_json::array();
    for (const auto& [first, second] : pairs) json.push_back(ordered_json::array({first, second}));
    return json;
}

ordered_json to_json(const Record::Part& part) {
    ordered_json json = ordered_json::object();
    if (part.far_start) json["far_start"] = *part.far_start;
    json["cliques"] = ordered_json::array();
    for (const auto& clique : part.cliques) json["cliques"].push_back(pairs_to_json(clique));
    json["stages"] = ordered_json::array();
    for (const Record::Stage& stage : part.stages) {
        json["stages"].push_back({{"heading", stage.heading},
                                  {"cones", pairs_to_json(stage.cones)},
                                  {"cliques", pairs_to_json(stage.cliques)}});
    }
    return json;
}

ordered_json to_json(const Record& record) {
    ordered_json json{{"scene", record.scene}};
    if (record.nearest) json["nearest"] = *record.nearest;
    put_parameter_tag(json, record.parameters);
    if (record.edges) json["edges"] = pairs_to_json(*record.edges);
    if (record.objective) json["objective"] = *record.objective;
    if (record.bound == kInfinity) {
        json["infeasible"] = true;
    } else {
        put_bound(json, record.bound, "bound");
    }
    json["parts"] = ordered_json::array();
    for (const Record::Part& part : record.parts) json["parts"].push_back(to_json(part));
    return json;
}

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

std::vector<SearchCertificateRecord> read_search_certificates(const std::filesystem::path& file) {
    std::vector<Record> records;
    for_each_json_line(file, [&](const JsonNode& json) { records.push_back(read_record(json)); });
    return records;
}

void write_search_certificates(const std::filesystem::path& file, std::span<const Record> records) {
    AtomicFile output(file);
    for (const Record& record : records) output.stream() << to_line(to_json(record)) << '\n';
    output.commit();
}

}  // namespace conelane
