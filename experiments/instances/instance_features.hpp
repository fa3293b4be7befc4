#pragma once

#include "conelane/lane_graph_problem.hpp"
#include "conelane/rld_parameters.hpp"
#include "conelane/scene.hpp"

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace conelane::experiments {

/// Features of an instance, a cone set with parameters, before it is solved. Groups are computed one after
/// the other, each with its own cost.
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
    struct Relaxation {  ///< the tight program without integrality, by Clp
        std::size_t columns = 0;
        std::size_t rows = 0;
        std::size_t entries = 0;
        double optimum = 0.0;
        double fractional = 0.0;       ///< share of the edges
        double degenerate = 0.0;       ///< share of the basis, see RelaxationShape
        double dual_degenerate = 0.0;  ///< share of the columns
    };
    Problem problem;
    double problem_ms = 0.0;
    std::optional<Relaxation> relaxation;  ///< absent if it is infeasible, or without candidates
    double relaxation_ms = 0.0;            ///< building the program included
};

/// The features of a problem.
[[nodiscard]] InstanceFeatures::Problem problem_features(const LaneGraphProblem& problem);

/// Throws InvalidInput if scene or parameters are invalid.
[[nodiscard]] InstanceFeatures features_of(const Scene& cones, const RldParameters& parameters);

/// The features by name, those of the problem first; absent ones are NaN.
struct NamedFeature {
    std::string_view name;
    double value;
};
[[nodiscard]] std::vector<NamedFeature> named(const InstanceFeatures& features);
/// Number of these features that belong to the problem.
inline constexpr std::size_t kProblemFeatures = 13;

}  // namespace conelane::experiments
