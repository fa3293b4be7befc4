#include "model/constraints/families.hpp"

namespace conelane::constraints {

int end_column(const FamilyContext& context, std::size_t edge, std::size_t cone) {
    return context.columns.end[edge][context.problem.edges[edge].i == cone ? 0 : 1];
}

void add_endpoint_mark(const FamilyContext& context, std::size_t cone, double coefficient) {
    if (context.columns.inlier.empty()) {
        for (const std::size_t edge : context.problem.incident[cone]) {
            context.rows.add(end_column(context, edge, cone), coefficient);
        }
        return;
    }
    context.rows.add(context.columns.inlier[cone], 2.0 * coefficient);
    for (const std::size_t edge : context.problem.incident[cone]) {
        context.rows.add(context.columns.edge[edge], -coefficient);
    }
}

void inlier_degree(const FamilyContext& context) {
    const auto& [problem, columns, rows] = context;
    for (std::size_t cone = 0; cone < problem.cone_count; ++cone) {
        const auto index = static_cast<std::int32_t>(cone);
        rows.begin({"inlier_has_edge", {index}}, -kInfinity, 0.0);  // (1)
        rows.add(columns.inlier[cone], 1.0);
        for (const std::size_t edge : problem.incident[cone]) rows.add(columns.edge[edge], -1.0);
        rows.end();
        rows.begin({"degree_at_most_two", {index}}, -kInfinity, 0.0);  // (2)
        rows.add(columns.inlier[cone], -2.0);
        for (const std::size_t edge : problem.incident[cone]) rows.add(columns.edge[edge], 1.0);
        rows.end();
    }
}

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
