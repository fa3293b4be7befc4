#include "evaluation/formats/solution_file.hpp"
#include "evaluation/progress/progress.hpp"
#include "evaluation/proofs/certificate_verifier.hpp"
#include "program/commands/command_parts.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"

#include <unordered_set>

namespace conelane::program {
namespace {

struct CertificateOptions {
    std::string scenes;
    std::string out;
    std::string verify;
    std::optional<std::size_t> nearest;
    double time_limit_ms = std::numeric_limits<double>::infinity();
    bool whole = false;
    std::int64_t max_steps = 5'000'000;
    ParameterSource parameters;
};

CertificateRecord to_record(const Scene& scene, const BoundCertificate& certificate) {
    CertificateRecord record;
    record.scene = scene.id;
    record.heading_multiplier = certificate.heading_multiplier;
    record.bound = certificate.bound;
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

/// Nothing if the record names a cone that is not in the scene; `missing` is then its id.
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

bool claims_nothing(double bound) {
    return !(bound > -SearchCertificate::kMaxBound);
}

/// Writes a certificate of each scene of the file, and prints the scenes of which nothing was proven. Throws
/// CLI::RuntimeError with exit code 1 if these are all.
template <typename Certify, typename Write>
void certify_all(const CertificateOptions& options, const RldParameters& parameters, const Certify& certify,
                 const Write& write) {
    const std::vector<AnnotatedScene> scenes = read_scenes(options.scenes);
    std::vector<std::invoke_result_t<Certify, const Scene&>> records;
    {
        Progress progress("certify", scenes.size());
        for (const AnnotatedScene& annotated : scenes) {
            records.push_back(certify(cones_asked_for(annotated.scene, options.nearest)));
            records.back().nearest = options.nearest;
            records.back().parameters = tag_of(options.parameters.name, parameters);
            progress.advance();
        }
    }
    write(options.out, records);
    fmt::print("{} certificates in {}\n", records.size(), options.out);
    std::size_t unproven = 0;
    for (const auto& record : records) {
        if (!claims_nothing(record.bound)) continue;
        ++unproven;
        fmt::print(stderr, "{}: nothing is claimed: no bound was proven in time\n", record.scene);
    }
    if (unproven > 0 && unproven == records.size()) throw CLI::RuntimeError(1);
}

/// Calls `verify(record, scene)` for each record with the cones that it is about: those of the options, or
/// else those of the record. Throws before the first call if a record is about other cones than the options
/// say.
template <typename Record, typename Verify>
void for_each_record(const CertificateOptions& options, const RldParameters& parameters,
                     const std::vector<Record>& records, const Verify& verify) {
    const ScenesById scenes(options.scenes);
    if (records.empty()) throw InputError(options.verify, 0, "", "holds no certificate");
    const ClaimBasis checked{tag_of(options.parameters.name, parameters), options.nearest};
    std::unordered_set<std::string> seen;
    for (const Record& record : records) {
        require_same_basis({record.parameters, record.nearest}, checked, options.verify, record.line);
        if (!seen.insert(record.scene).second)
            throw InputError(options.verify, record.line, "scene", "'" + record.scene + "' is there twice");
    }
    Progress progress("verify", records.size());
    for (const Record& record : records) {
        const Scene& scene = scenes.of(record.scene, options.verify, record.line).scene;
        verify(record, cones_asked_for(scene, options.nearest ? options.nearest : record.nearest));
        progress.advance();
    }
    if (const std::size_t without = scenes.all().size() - records.size(); without > 0)
        fmt::print(stderr, "conelane: {}: {} of {} scenes have no certificate\n", options.verify, without,
                   scenes.all().size());
}

std::string no_cone(ConeId id) {
    return fmt::format("cone {} is not in the scene", id);
}

void report_none_verified(const CertificateOptions& options, bool is_none) {
    if (is_none) fmt::print(stderr, "conelane: {}: no certificate is verified\n", options.verify);
}

void verify_bounds(const CertificateOptions& options, const RldParameters& parameters) {
    const std::vector<CertificateRecord> records = read_certificates(options.verify);
    std::size_t failed = 0;
    for_each_record(options, parameters, records, [&](const CertificateRecord& record, const Scene& scene) {
        ConeId missing{};
        std::vector<std::string> violations;
        if (claims_nothing(record.bound)) {
            violations.emplace_back("nothing is claimed");
        } else if (const auto certificate = from_record(scene, record, missing)) {
            violations = verify_bound(scene, parameters, *certificate).violations;
        } else {
            violations.push_back(no_cone(missing));
        }
        for (const std::string& violation : violations) fmt::print("{}: {}\n", record.scene, violation);
        if (!violations.empty()) ++failed;
    });
    fmt::print("{} verified, {} failed\n", records.size() - failed, failed);
    report_none_verified(options, failed == records.size());
    if (failed > 0) throw CLI::RuntimeError(1);
}

void verify_searches(const CertificateOptions& options, const RldParameters& parameters) {
    using Kind = SearchVerdict::Kind;
    const std::vector<SearchCertificateRecord> records = read_search_certificates(options.verify);
    std::size_t optima = 0;
    std::size_t infeasible = 0;
    std::size_t bounds = 0;
    std::size_t refused = 0;
    std::size_t unverified = 0;
    for_each_record(options, parameters, records,
                    [&](const SearchCertificateRecord& record, const Scene& scene) {
                        ConeId missing{};
                        SearchVerdict verdict;
                        if (const auto certificate = from_search_record(scene, record, missing)) {
                            verdict = verify_search(scene, parameters, *certificate, options.max_steps);
                        } else {
                            verdict.reason = no_cone(missing);
                        }
                        if (verdict.kind != Kind::verified)
                            fmt::print("{}: {}\n", record.scene, verdict.reason);
                        if (verdict.kind == Kind::unverified) ++unverified;
                        if (verdict.kind == Kind::refused) ++refused;
                        if (verdict.kind == Kind::verified)
                            ++(verdict.is_optimum ? optima : std::isinf(record.bound) ? infeasible : bounds);
                    });
    fmt::print(
        "verified: {} optima, {} infeasible, {} lower bounds; {} refused; {} not verified within {} steps\n",
        optima, infeasible, bounds, refused, unverified, options.max_steps);
    report_none_verified(options, refused + unverified == records.size());
    if (refused + unverified > 0) throw CLI::RuntimeError(1);
}

void run(const CertificateOptions& options, const RldParameters& parameters) {
    if (!options.verify.empty()) {
        const bool whole = options.whole || holds_search_certificates(options.verify);
        return whole ? verify_searches(options, parameters) : verify_bounds(options, parameters);
    }
    const auto problem_of = [&](const Scene& scene) { return make_problem(scene, parameters); };
    if (options.whole) {
        const auto certify = [&](const Scene& scene) {
            return to_search_record(scene, certify_search(problem_of(scene), options.time_limit_ms));
        };
        return certify_all(options, parameters, certify, write_search_certificates);
    }
    if (parameters.pairing != Pairing::near_far)
        throw InvalidInput("--params", "root certificates are for the pairing near_far");
    const auto certify = [&](const Scene& scene) {
        return to_record(scene, certify_root_bound(problem_of(scene), options.time_limit_ms));
    };
    certify_all(options, parameters, certify, write_certificates);
}

}  // namespace

void add_certify_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand(
        "certify",
        "writes Lagrange multipliers that prove a lower bound of each scene's optimum; with --whole, a "
        "certificate from which the proof of the optimum can be repeated. --verify verifies either file "
        "independently of the solver; exit code 1 if not everything is verified");
    auto options = std::make_shared<CertificateOptions>();
    command.add_option("--scenes", options->scenes, "*.scenes.jsonl")->required();
    CLI::Option_group& what = *command.add_option_group("what to do");
    add_output_option(what, "--out", options->out, "*.certificates.jsonl to write");
    what.add_option("--verify", options->verify, "*.certificates.jsonl to verify");
    what.require_option(1);
    command.add_flag("--whole", options->whole,
                     "certificates of whole searches, verified in rational arithmetic, instead of the root's "
                     "bound; --verify recognises which a file holds");
    command
        .add_option("--most-steps", options->max_steps,
                    "largest number of labels and fronts to verify a whole search; a search that needs more "
                    "is not verified")
        ->check(CLI::Range(std::int64_t{1}, std::int64_t{1'000'000'000'000}))
        ->capture_default_str();
    add_nearest_option(command, options->nearest,
                       "only the N nearest cones ahead; without it all, or those that a certificate names");
    add_time_limit_option(command, options->time_limit_ms);
    add_parameter_options(command, options->parameters, "the defaults");
    command.callback([options] { run(*options, options->parameters.load()); });
}

}  // namespace conelane::program
