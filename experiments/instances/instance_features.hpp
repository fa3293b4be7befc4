#pragma once

#include "conelane/lane_graph_problem.hpp"

#include <cstddef>
#include <string_view>
#include <vector>

namespace conelane::experiments {

/// Features of an instance, a cone set with parameters, before it is solved.
struct InstanceFeatures {
    struct Problem {  ///< from cones to numbers
        std::size_t cones = 0;
        std::size_t near_cones = 0;
        std::size_t edges = 0;      ///< candidates that (27) allows
        double edge_density = 0.0;  ///< of all pairs of cones
        std::size_t turns = 0;
        std::size_t allowed_turns = 0;  ///< by (28)
        std::size_t conflicts = 0;      ///< pairs of edges too close (7)
        double conflict_density = 0.0;  ///< of all pairs of edges
        std::size_t far_apart = 0;      ///< pairs of far cones that cannot both be ends (17)
        double mean_degree = 0.0;       ///< candidates at a cone
        double max_degree = 0.0;
        double min_cost = 0.0;  ///< of a candidate
        double mean_cost = 0.0;
    };
    Problem problem;
};

/// The features of a problem.
[[nodiscard]] InstanceFeatures::Problem problem_features(const LaneGraphProblem& problem);

/// The features by name.
struct NamedFeature {
    std::string_view name;
    double value;
};
[[nodiscard]] std::vector<NamedFeature> named(const InstanceFeatures& features);
/// Number of these features.
inline constexpr std::size_t kProblemFeatures = 13;

}  // namespace conelane::experiments
