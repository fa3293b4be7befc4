#include "conelane/bound_certificate.hpp"
#include "conelane/invalid_input.hpp"
#include "conelane/lane_graph_problem.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/files/certificate_file.hpp"
#include "experiments/files/input_error.hpp"
#include "experiments/options/shared_options.hpp"
#include "experiments/progress.hpp"
#include "experiments/scenes/cone_index.hpp"
#include "experiments/scenes/scene_file.hpp"
#include "solvers/path_pair_solver.hpp"

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

struct Options {
    std::string scenes;
    std::string out;
    std::string verify;
    std::optional<std::size_t> nearest;
    double time_limit_ms = std::numeric_limits<double>::infinity();
    ParameterSource parameters;
};

Scene cone_set(const Options& options, const Scene& scene) {
    return options.nearest ? nearest_ahead(scene, *options.nearest) : scene;
}

CertificateRecord to_record(const Scene& scene, const BoundCertificate& certificate) {
    CertificateRecord record{scene.id, {}, {}, certificate.heading_multiplier, certificate.bound};
    for (std::size_t i = 0; i < scene.cones.size(); ++i) {
        if (certificate.cone_multiplier[i] == 0.0) continue;
        record.cone_multipliers.emplace_back(scene.cones[i].id, certificate.cone_multiplier[i]);
    }
    for (const BoundCertificate::Clique& clique : certificate.cliques) {
        CertificateRecord::Clique& listed = record.cliques.emplace_back();
        listed.multiplier = clique.multiplier;
        for (const Edge& edge : clique.edges) {
            listed.edges.emplace_back(scene.cones[edge.i].id, scene.cones[edge.j].id);
        }
    }
    return record;
}

/// Nothing where the record names a cone that is not in the scene; `missing` is then its id.
std::optional<BoundCertificate> from_record(const Scene& scene, const CertificateRecord& record,
                                            ConeId& missing) {
    const auto index_of = index_by_id(scene);
    const auto known = [&](ConeId id) {
        missing = id;
        return index_of.contains(id);
    };
    BoundCertificate certificate{
        std::vector<double>(scene.cones.size(), 0.0), {}, record.heading_multiplier, record.bound};
    for (const auto& [id, multiplier] : record.cone_multipliers) {
        if (!known(id)) return std::nullopt;
        certificate.cone_multiplier[index_of.at(id)] += multiplier;
    }
    for (const CertificateRecord::Clique& listed : record.cliques) {
        BoundCertificate::Clique& clique = certificate.cliques.emplace_back();
        clique.multiplier = listed.multiplier;
        for (const auto& [a, b] : listed.edges) {
            if (!known(a) || !known(b)) return std::nullopt;
            clique.edges.push_back(make_edge(index_of.at(a), index_of.at(b)));
        }
    }
    return certificate;
}

void certify(const Options& options, const RldParameters& parameters) {
    if (parameters.pairing != Pairing::near_far || parameters.w_color > 0.0) {
        throw InvalidInput("--params", "certificates are for the pairing near_far without colour costs");
    }
    const std::vector<AnnotatedScene> scenes = read_scenes(options.scenes);
    std::vector<CertificateRecord> records;
    records.reserve(scenes.size());
    Progress progress("certify", scenes.size());
    for (const AnnotatedScene& annotated : scenes) {
        const Scene scene = cone_set(options, annotated.scene);
        records.push_back(
            to_record(scene, certify_root_bound(make_problem(scene, parameters), options.time_limit_ms)));
        progress.advance();
    }
    write_certificates(options.out, records);
}

void verify(const Options& options, const RldParameters& parameters) {
    const std::vector<AnnotatedScene> scenes = read_scenes(options.scenes);
    std::unordered_map<std::string, const Scene*> scene_of;
    for (const AnnotatedScene& scene : scenes) scene_of.emplace(scene.scene.id, &scene.scene);
    const std::vector<CertificateRecord> records = read_certificates(options.verify);
    std::size_t failed = 0;
    if (records.empty()) throw InputError(options.verify, 0, "", "holds no certificate");
    for (const CertificateRecord& record : records) {
        const auto found = scene_of.find(record.scene);
        if (found == scene_of.end()) {
            throw InputError(options.verify, record.line, "scene",
                             "'" + record.scene + "' is not in the scenes file");
        }
        const Scene scene = cone_set(options, *found->second);
        ConeId missing{};
        std::vector<std::string> violations;
        if (const auto certificate = from_record(scene, record, missing)) {
            violations = verify_bound(scene, parameters, *certificate).violations;
        } else {
            violations.push_back(fmt::format("cone {} is not in the scene", missing));
        }
        for (const std::string& violation : violations) fmt::print("{}: {}\n", record.scene, violation);
        if (!violations.empty()) ++failed;
    }
    fmt::print("{} verified, {} failed\n", records.size() - failed, failed);
    if (failed > 0) throw CLI::RuntimeError(1);
}

}  // namespace

void add_certify_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand("certify",
                                                "Lagrange multipliers that prove a lower bound of each "
                                                "scene's optimum; --verify recomputes such bounds "
                                                "independently of the solver, exit code 1 on a failure");
    auto options = std::make_shared<Options>();
    command.add_option("--scenes", options->scenes, "*.scenes.jsonl")->required();
    CLI::Option_group& what = *command.add_option_group("what to do");
    add_output_option(what, "--out", options->out, "*.certificates.jsonl to write");
    what.add_option("--verify", options->verify, "*.certificates.jsonl to verify");
    what.require_option(1);
    add_nearest_option(command, options->nearest, "the N nearest cones ahead only; all without it");
    add_time_limit_option(command, options->time_limit_ms);
    add_parameter_options(command, options->parameters, "the defaults");
    command.callback([options] {
        const RldParameters parameters = options->parameters.load();
        if (options->verify.empty()) {
            certify(*options, parameters);
        } else {
            verify(*options, parameters);
        }
    });
}

}  // namespace conelane::experiments
