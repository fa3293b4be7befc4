#include "model/constraints/families.hpp"

namespace conelane::constraints {

void heading(const FamilyContext& context) {
    const auto& [problem, columns, rows] = context;
    rows.begin({"heading"}, 2.0, kInfinity);
    for (std::size_t edge = 0; edge < problem.edges.size(); ++edge) {
        if (problem.edges[edge].along_heading) rows.add(columns.edge[edge], 1.0);
    }
    rows.end();
}

}  // namespace conelane::constraints
