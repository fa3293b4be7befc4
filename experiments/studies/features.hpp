#pragma once

#include "evaluation/world/annotated_scene.hpp"
#include "experiments/instances/instance_features.hpp"
#include "experiments/studies/cone_sets.hpp"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace conelane::experiments {

class Study;

/// Features of instances, the cost of computing them, and the gap of the relaxation.
[[nodiscard]] std::unique_ptr<Study> make_features_study();

struct FeatureRow {
    const AnnotatedScene* scene = nullptr;
    std::size_t cones = 0;
    InstanceFeatures features;
    double solve_ms = 0.0;  ///< of path-pair
    /// (optimum - relaxation) / max(1, |optimum|); absent without a proven optimum or a relaxation.
    std::optional<double> lp_gap;
};
/// Rows by size and scene.
[[nodiscard]] std::vector<FeatureRow> feature_rows(std::span<const AnnotatedScene> scenes,
                                                   const ConeSetOptions& options);

/// A line for each size: medians.
[[nodiscard]] std::string feature_table(std::span<const FeatureRow> rows);

}  // namespace conelane::experiments
