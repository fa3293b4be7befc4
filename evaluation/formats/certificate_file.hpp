#pragma once

#include "conelane/scene.hpp"
#include "evaluation/formats/parameter_tag.hpp"

#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace conelane {

/// A line of a `*.certificates.jsonl` file: multipliers that prove a lower bound of a scene's optimum, see
/// BoundCertificate, with cones by id. Unlisted multipliers are 0. The keys of the file call a multiplier
/// `price`.
struct CertificateRecord {
    struct Clique {
        std::vector<std::pair<ConeId, ConeId>> edges;
        double multiplier;
    };
    std::string scene;
    std::vector<std::pair<ConeId, double>> cone_multipliers;
    std::vector<Clique> cliques;
    double heading_multiplier = 0.0;
    /// Infinite if the multipliers prove that no lane graph exists, minus infinity if nothing is claimed.
    double bound = -std::numeric_limits<double>::infinity();
    std::optional<std::size_t> nearest;  ///< size of the cone set; absent: all cones, or unknown
    ParameterTag parameters = {};        ///< parameters of the costs
    std::size_t line = 0;                ///< line in the file that was read; 0 without a file
};

/// Records in the order of the file. Throws InputError naming file, line and key.
[[nodiscard]] std::vector<CertificateRecord> read_certificates(const std::filesystem::path& file);

/// Throws InvalidInput if a multiplier is not finite, InputError if the file cannot be written. An old file
/// then stays unchanged.
void write_certificates(const std::filesystem::path& file, std::span<const CertificateRecord> records);

}  // namespace conelane
