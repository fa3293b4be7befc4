#include "model/constraints/families.hpp"

namespace conelane::constraints {

void far_marks(const FamilyContext& context) {
    const auto& [problem, columns, rows] = context;
    for (std::size_t cone = 0; cone < problem.cone_count; ++cone) {
        rows.begin({"far_mark", {static_cast<std::int32_t>(cone)}}, 1.0, 1.0);
        if (!problem.near[cone]) add_endpoint_mark(context, cone, 1.0);
        rows.add(columns.not_far[cone], 1.0);
        rows.end();
    }
}

void far_distance(const FamilyContext& context) {
    const auto& [problem, columns, rows] = context;
    for (std::size_t i = 0; i < problem.cone_count; ++i) {
        for (std::size_t j = 0; j < problem.cone_count; ++j) {
            if (i == j) continue;
            const double distance = problem.distance_m[i][j];
            rows.begin({"far_distance", {static_cast<std::int32_t>(i), static_cast<std::int32_t>(j)}},
                       -kInfinity, problem.parameters.d_max);
            if (!problem.near[i]) add_endpoint_mark(context, i, distance);
            rows.add(columns.not_far[j], -distance);
            rows.end();
        }
    }
}

// Of two far cones more than d_max apart, at most one is an endpoint.
void far_pairs(const FamilyContext& context) {
    for (const auto& [i, j] : context.problem.far_apart) {
        context.rows.begin({"far_pair", {static_cast<std::int32_t>(i), static_cast<std::int32_t>(j)}},
                           -kInfinity, 1.0);
        add_endpoint_mark(context, i, 1.0);
        add_endpoint_mark(context, j, 1.0);
        context.rows.end();
    }
}

}  // namespace conelane::constraints
