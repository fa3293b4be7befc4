#pragma once

#include "conelane/rld_parameters.hpp"
#include "conelane/solve_report.hpp"
#include "evaluation/world/annotated_scene.hpp"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace conelane::experiments {

class Study;

/// What path-pair knows of a scene when the time limit ends: incumbent and proven bound.
[[nodiscard]] std::unique_ptr<Study> make_anytime_study();

struct AnytimeOptions {
    RldParameters parameters;
    std::vector<double> limits_ms{5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0};
    std::optional<std::size_t> limit;  ///< largest number of scenes, evenly spread; all if absent
};

/// One scene under one limit.
struct AnytimeRow {
    const AnnotatedScene* scene = nullptr;
    double limit_ms = 0.0;
    bool proven = false;  ///< the optimum, or that there is no lane graph
    std::optional<double> objective;
    std::optional<double> bound;
    std::optional<double> best_known;  ///< the lowest objective under any limit
};

/// Scene by scene, limits ascending. A scene proven under a limit counts as proven under longer limits.
/// Throws InvalidInput if limits do not ascend or a solve ends in an error.
[[nodiscard]] std::vector<AnytimeRow> anytime_rows(std::span<const AnnotatedScene> scenes,
                                                   const AnytimeOptions& options);

/// (best known - bound) / max(1, |best known|) of an unproven scene, 0 of a proven one; nothing if no lane
/// graph or no bound is known.
[[nodiscard]] std::optional<double> proven_gap(const AnytimeRow& row);

/// Limit by limit, for a terminal.
[[nodiscard]] std::string anytime_table(std::span<const AnytimeRow> rows, std::span<const double> limits_ms);

}  // namespace conelane::experiments
