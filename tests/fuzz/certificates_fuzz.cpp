// Certificates of both kinds: the readers, and the verifiers on everything that is read. A verifier must not
// accept a bound above the optimum.

#include "conelane/bound_certificate.hpp"
#include "conelane/lane_graph_problem.hpp"
#include "evaluation/formats/solution_file.hpp"
#include "evaluation/proofs/certificate_verifier.hpp"
#include "tests/fuzz/expectations.hpp"
#include "tests/fuzz/scratch_folder.hpp"
#include "tests/support/six_cone_lane.hpp"

namespace conelane::fuzz {
namespace {

/// The seeds in corpus/certificates are proofs about the lane of six cones, whose optimum is the whole lane.
constexpr double kOptimum = -4.0;
constexpr double kTolerance = 1e-5;

/// The cones of `record` are 0 to 5, which are their indices too.
std::optional<BoundCertificate> certificate_of(const CertificateRecord& record, std::size_t cones) {
    const auto known = [&](ConeId id) { return id >= 0 && static_cast<std::size_t>(id) < cones; };
    BoundCertificate certificate{
        std::vector<double>(cones, 0.0), {}, record.heading_multiplier, record.bound};
    for (const auto& [id, multiplier] : record.cone_multipliers) {
        if (!known(id)) return std::nullopt;
        certificate.cone_multiplier[static_cast<std::size_t>(id)] += multiplier;
    }
    for (const auto& listed : record.cliques) {
        auto& clique = certificate.cliques.emplace_back();
        clique.multiplier = listed.multiplier;
        for (const auto& [a, b] : listed.edges) {
            if (!known(a) || !known(b)) return std::nullopt;
            clique.edges.push_back(make_edge(static_cast<std::size_t>(a), static_cast<std::size_t>(b)));
        }
    }
    return certificate;
}

void read_all(std::string_view bytes) {
    static const ScratchFolder folder;
    static const Scene scene = tests::six_cone_lane();
    const auto file = folder.write("input.certificates.jsonl", bytes);
    (void)holds_search_certificates(file);
    answers([&] {
        for (const auto& record : read_certificates(file)) {
            const auto certificate = certificate_of(record, scene.cones.size());
            if (!certificate) continue;
            const BoundVerdict verdict = verify_bound(scene, {}, *certificate);
            require(!verdict.violations.empty() || record.bound <= kOptimum + kTolerance,
                    "no bound above the optimum is proven");
        }
    });
    answers([&] {
        for (const auto& record : read_search_certificates(file)) {
            ConeId missing{};
            const auto certificate = from_search_record(scene, record, missing);
            if (!certificate) continue;
            constexpr std::int64_t kMaxSteps = 10'000;
            const auto verdict = verify_search(scene, {}, *certificate, kMaxSteps);
            if (verdict.kind == SearchVerdict::Kind::verified) {
                require(certificate->bound <= kOptimum + kTolerance, "no bound above the optimum is proven");
            } else {
                require(!verdict.reason.empty(), "who refuses says why");
            }
        }
    });
}

}  // namespace
}  // namespace conelane::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    conelane::fuzz::read_all({reinterpret_cast<const char*>(data), size});
    return 0;
}
