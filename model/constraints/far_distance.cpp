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

// Exactly two endpoints are far, by (3) and (11), so a far endpoint i has the other one within d_max of it:
//   m_i <= sum of m_j over the far cones j != i with D_ij <= d_max.
// Stronger in the relaxation than m_i + m_j <= 1 for each pair more than d_max apart, and a row a cone.
void far_partners(const FamilyContext& context) {
    const auto& [problem, columns, rows] = context;
    const std::size_t n = problem.cone_count;
    std::vector<bool> apart(n * n, false);
    for (const auto& [i, j] : problem.far_apart) apart[i * n + j] = apart[j * n + i] = true;
    for (std::size_t i = 0; i < n; ++i) {
        if (problem.near[i]) continue;
        rows.begin({"far_partner", {static_cast<std::int32_t>(i)}}, -kInfinity, 0.0);
        add_endpoint_mark(context, i, 1.0);
        for (std::size_t j = 0; j < n; ++j) {
            if (j != i && !problem.near[j] && !apart[i * n + j]) add_endpoint_mark(context, j, -1.0);
        }
        rows.end();
    }
}

}  // namespace conelane::constraints
