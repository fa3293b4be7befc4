#pragma once

#include "conelane/rld_parameters.hpp"
#include "conelane/scene.hpp"
#include "conelane/solve_report.hpp"
#include "evaluation/world/annotated_scene.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace conelane::experiments {

class Study;

/// Cost of path-pair against the number of cones and their density.
[[nodiscard]] std::unique_ptr<Study> make_growth_study();

struct GrowthOptions {
    RldParameters parameters;
    std::vector<std::size_t> sizes{12, 20, 30, 40, 60, 80, 120};
    double time_limit_ms = 1000.0;     ///< a solve
    std::optional<std::size_t> limit;  ///< largest number of scenes, evenly spread; all if absent
};

struct GrowthRow {
    const AnnotatedScene* scene = nullptr;
    std::size_t cones = 0;
    bool all_visible = false;  ///< false: the nearest cones of a scene that has more
    double density = 0.0;      ///< see neighbours_per_cone
    std::size_t edges = 0;     ///< that (27) allows
    bool proven = false;
    std::int64_t nodes = 0;
    double cpu_ms = 0.0;  ///< processor time of the thread, from the scene to the answer
};

/// Mean number of other cones within 5.5 m of a cone.
[[nodiscard]] double neighbours_per_cone(const Scene& scene);

/// Each scene at each size below its number of cones, and with all its cones. Throws InvalidInput if a solve
/// ends in an error.
[[nodiscard]] std::vector<GrowthRow> growth_rows(std::span<const AnnotatedScene> scenes,
                                                 const GrowthOptions& options);

/// By size; and for all visible cones by density, number of edges and course.
[[nodiscard]] std::string growth_tables(std::span<const GrowthRow> rows);

}  // namespace conelane::experiments
