#pragma once

#include "conelane/scene.hpp"
#include "experiments/files/parameter_tag.hpp"
#include "model/search_certificate.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace conelane::experiments {

/// A line of a file of whole-search certificates: a SearchCertificate with cones by id. Cones and cliques
/// that are not listed have the multiplier 0.
struct SearchCertificateRecord {
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
    std::string scene;
    std::optional<std::vector<EdgeById>> edges;  ///< of the lane graph
    std::optional<double> objective;
    /// Infinite where it is claimed that no lane graph exists, minus infinity where nothing is claimed.
    double bound = 0.0;
    std::vector<Part> parts;
    std::optional<std::size_t> nearest;  ///< size of the cone set; absent: all cones, or it is not said
    ParameterTag parameters = {};        ///< of the costs that it is about
    std::size_t line = 0;                ///< in the file that was read; 0 where no file was read
};

[[nodiscard]] SearchCertificateRecord to_search_record(const Scene& scene,
                                                       const SearchCertificate& certificate);

/// Nothing where the record names a cone that is not in the scene; `missing` is then its id.
[[nodiscard]] std::optional<SearchCertificate> from_search_record(const Scene& scene,
                                                                  const SearchCertificateRecord& record,
                                                                  ConeId& missing);

/// Whether the first record is one of a whole search; false where there is none, or no file.
[[nodiscard]] bool holds_search_certificates(const std::filesystem::path& file);

/// Records in the order of the file. Throws InputError naming file, line and key.
[[nodiscard]] std::vector<SearchCertificateRecord> read_search_certificates(
    const std::filesystem::path& file);

/// Throws InputError where the file cannot be written. An old file then stays as it was.
void write_search_certificates(const std::filesystem::path& file,
                               std::span<const SearchCertificateRecord> records);

}  // namespace conelane::experiments
