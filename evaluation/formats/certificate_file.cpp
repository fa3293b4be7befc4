#include "evaluation/formats/certificate_file.hpp"

#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/json_node.hpp"

namespace conelane {
namespace {

using nlohmann::ordered_json;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Two elements; `what` names them in the message.
std::pair<JsonNode, JsonNode> read_pair(const JsonNode& json, const std::string& what) {
    if (json.array_size() != 2) json.fail("must be a pair of " + what);
    return {json.element(0), json.element(1)};
}

CertificateRecord::Clique read_clique(const JsonNode& json) {
    CertificateRecord::Clique clique{{}, json.member("price").number()};
    const JsonNode edges = json.member("edges");
    for (std::size_t k = 0; k < edges.array_size(); ++k) {
        const auto [first, second] = read_pair(edges.element(k), "cone ids");
        clique.edges.emplace_back(first.integer(), second.integer());
    }
    return clique;
}

CertificateRecord read_record(const JsonNode& json) {
    CertificateRecord record;
    record.line = json.line();
    record.scene = json.member("scene").string();
    const auto bound = json.find("bound");
    const auto infeasible = json.find("infeasible");
    if (bound) record.bound = bound->number();
    if (infeasible && infeasible->boolean()) {
        if (bound) bound->fail("must be left out if the scene is called infeasible");
        record.bound = kInfinity;
    }
    if (const auto nearest = json.find("nearest")) {
        record.nearest = static_cast<std::size_t>(nearest->non_negative_integer());
    }
    record.parameters = read_parameter_tag(json);
    record.heading_multiplier = json.member("heading_price").number();
    const JsonNode multipliers = json.member("cone_prices");
    for (std::size_t k = 0; k < multipliers.array_size(); ++k) {
        const auto [cone, multiplier] = read_pair(multipliers.element(k), "cone id and multiplier");
        record.cone_multipliers.emplace_back(cone.integer(), multiplier.number());
    }
    const JsonNode cliques = json.member("cliques");
    for (std::size_t k = 0; k < cliques.array_size(); ++k) {
        record.cliques.push_back(read_clique(cliques.element(k)));
    }
    return record;
}

ordered_json to_json(const CertificateRecord& record, const std::string& key) {
    ordered_json multipliers = ordered_json::array();
    for (const auto& [cone, multiplier] : record.cone_multipliers) {
        multipliers.push_back(ordered_json::array({cone, require_finite(multiplier, key + "cone_prices")}));
    }
    ordered_json cliques = ordered_json::array();
    for (const CertificateRecord::Clique& clique : record.cliques) {
        ordered_json edges = ordered_json::array();
        for (const auto& [i, j] : clique.edges) edges.push_back(ordered_json::array({i, j}));
        cliques.push_back(
            {{"price", require_finite(clique.multiplier, key + "cliques")}, {"edges", std::move(edges)}});
    }
    ordered_json json{{"scene", record.scene}};
    if (record.nearest) json["nearest"] = *record.nearest;
    put_parameter_tag(json, record.parameters);
    if (record.bound == kInfinity) {
        json["infeasible"] = true;
    } else {
        put_bound(json, record.bound, key + "bound");
    }
    json["heading_price"] = require_finite(record.heading_multiplier, key + "heading_price");
    json["cone_prices"] = std::move(multipliers);
    json["cliques"] = std::move(cliques);
    return json;
}

}  // namespace

std::vector<CertificateRecord> read_certificates(const std::filesystem::path& file) {
    std::vector<CertificateRecord> records;
    for_each_json_line(file, [&](const JsonNode& json) { records.push_back(read_record(json)); });
    return records;
}

void write_certificates(const std::filesystem::path& file, std::span<const CertificateRecord> records) {
    AtomicFile output(file);
    for (std::size_t i = 0; i < records.size(); ++i) {
        output.stream() << to_line(to_json(records[i], "certificates[" + std::to_string(i) + "].")) << '\n';
    }
    output.commit();
}

}  // namespace conelane
