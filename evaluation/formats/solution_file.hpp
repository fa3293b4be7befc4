#pragma once

#include "conelane/stop_reason.hpp"
#include "evaluation/formats/parameter_file.hpp"
#include "model/search_certificate.hpp"

#include <limits>

namespace conelane {

/// A line of a `*.solutions.jsonl` file: a solver's claim about a scene. The checker decides whether the
/// edges are a lane graph.
struct SolutionRecord {
    std::string scene;
    std::string solver;
    std::string formulation;
    std::string status;   ///< optimal, feasible, infeasible, stopped or error
    std::string message;  ///< why it has this status; always there with error
    std::vector<std::pair<ConeId, ConeId>> edges;
    std::optional<double> objective;
    std::optional<double> bound;
    std::optional<std::int64_t> nodes;
    double build_ms = 0.0;
    double solve_ms = 0.0;
    std::optional<StopReason> stopped_by;  ///< the limit that ended the search, if one did
    std::optional<std::size_t> nearest;    ///< size of the cone set that was solved; absent: all cones
    ParameterTag parameters = {};          ///< parameters of the objective
    std::size_t line = 0;                  ///< line in the file that was read; 0 without a file
};

/// Records in the order of the file, which may be empty. Throws InputError naming file, line and key for
/// invalid JSON, for edges with a status other than optimal and feasible, and for a second answer of a solver
/// to a scene with the same formulation.
[[nodiscard]] std::vector<SolutionRecord> read_solutions(const std::filesystem::path& file);

/// A bound of minus infinity (nothing proven) is left out. Throws InvalidInput if another number is not
/// finite, InputError if the file cannot be written; an old file then stays unchanged.
void write_solutions(const std::filesystem::path& file, std::span<const SolutionRecord> records);

/// What the certificates of both kinds say of their claim.
struct CertificateClaim {
    std::string scene;
    /// Infinite if it is claimed that no lane graph exists, minus infinity if nothing is claimed.
    double bound = -std::numeric_limits<double>::infinity();
    std::optional<std::size_t> nearest = {};  ///< size of the cone set; absent: all cones, or unknown
    ParameterTag parameters = {};             ///< parameters of the costs
    std::size_t line = 0;                     ///< line in the file that was read; 0 without a file
};

/// A line of a `*.certificates.jsonl` file: multipliers that prove a lower bound of a scene's optimum, see
/// BoundCertificate, with cones by id. Unlisted multipliers are 0. The keys of the file call a multiplier
/// `price`.
struct CertificateRecord : CertificateClaim {
    struct Clique {
        std::vector<std::pair<ConeId, ConeId>> edges;
        double multiplier;
    };
    std::vector<std::pair<ConeId, double>> cone_multipliers;
    std::vector<Clique> cliques;
    double heading_multiplier = 0.0;
};

/// A line of a file of whole-search certificates: a SearchCertificate with cones by id. Cones and cliques
/// that are not listed have the multiplier 0.
struct SearchCertificateRecord : CertificateClaim {
    using Units = SearchCertificate::Units;
    using EdgeById = std::pair<ConeId, ConeId>;
    struct Stage {
        std::vector<std::pair<ConeId, Units>> cones;
        std::vector<std::pair<std::size_t, Units>> cliques;
        Units heading = 0;
    };
    struct Part {
        std::optional<ConeId> far_start;
        std::vector<std::vector<EdgeById>> cliques;
        std::vector<Stage> stages;
    };
    std::optional<std::vector<EdgeById>> edges;  ///< of the lane graph
    std::optional<double> objective;
    std::vector<Part> parts;
};

/// Records in the order of the file. Both throw InputError naming file, line and key.
[[nodiscard]] std::vector<CertificateRecord> read_certificates(const std::filesystem::path& file);
[[nodiscard]] std::vector<SearchCertificateRecord> read_search_certificates(
    const std::filesystem::path& file);

/// Both throw InvalidInput if a number is not finite, InputError if the file cannot be written. An old file
/// then stays unchanged.
void write_certificates(const std::filesystem::path& file, std::span<const CertificateRecord> records);
void write_search_certificates(const std::filesystem::path& file,
                               std::span<const SearchCertificateRecord> records);

[[nodiscard]] SearchCertificateRecord to_search_record(const Scene& scene,
                                                       const SearchCertificate& certificate);

/// Nothing if the record names a cone that is not in the scene; `missing` is then its id.
[[nodiscard]] std::optional<SearchCertificate> from_search_record(const Scene& scene,
                                                                  const SearchCertificateRecord& record,
                                                                  ConeId& missing);

/// Whether the first record is one of a whole search; false without a record or a file.
[[nodiscard]] bool holds_search_certificates(const std::filesystem::path& file);

}  // namespace conelane
