#include "model/constraints/families.hpp"

namespace conelane::constraints {

void four_endpoints(const FamilyContext& context) {
    context.rows.begin({"four_endpoints"}, 4.0, 4.0);
    for (std::size_t cone = 0; cone < context.problem.cone_count; ++cone)
        add_endpoint_mark(context, cone, 1.0);
    context.rows.end();
}

void two_paths(const FamilyContext& context) {
    const auto& [problem, columns, rows] = context;
    rows.begin({"two_paths"}, -kInfinity, -2.0);
    for (const int edge : columns.edge) rows.add(edge, 1.0);  // half of sum A_i
    for (const int inlier : columns.inlier) rows.add(inlier, -1.0);
    rows.end();
}

void near_endpoints(const FamilyContext& context) {
    context.rows.begin({"near_endpoints"}, 2.0, 2.0);
    for (std::size_t cone = 0; cone < context.problem.cone_count; ++cone) {
        if (context.problem.near[cone]) add_endpoint_mark(context, cone, 1.0);
    }
    context.rows.end();
}

}  // namespace conelane::constraints
