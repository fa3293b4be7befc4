#pragma once

#include "conelane/scene.hpp"

#include <cstddef>
#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace conelane::experiments {

/// A line of a `*.certificates.jsonl` file: prices that prove a lower bound of a scene's optimum, see
/// BoundCertificate, with cones by id. What is not listed has the price 0.
struct CertificateRecord {
    struct Clique {
        std::vector<std::pair<ConeId, ConeId>> edges;
        double price;
    };
    std::string scene;
    std::vector<std::pair<ConeId, double>> cone_prices;
    std::vector<Clique> cliques;
    double heading_price = 0.0;
    /// Infinite where the prices prove that there is no lane graph, minus infinity where nothing is claimed.
    double bound = -std::numeric_limits<double>::infinity();
    std::size_t line = 0;  ///< in the file that was read; 0: none was
};

/// Records in the order of the file. Throws InputError naming file, line and key.
[[nodiscard]] std::vector<CertificateRecord> read_certificates(const std::filesystem::path& file);

/// Throws InvalidInput where a price is not finite, InputError where the file cannot be written; then an old
/// file stays as it was.
void write_certificates(const std::filesystem::path& file, std::span<const CertificateRecord> records);

}  // namespace conelane::experiments
