#include "model/constraints/conflict_graph.hpp"
#include "model/constraints/families.hpp"

namespace conelane::constraints {
namespace {

/// Larger than every valid d_max. Larger coefficients would only disturb solvers [m].
constexpr double kMaxDistance_m = 1e6;
/// A distance beyond d_max is set this share of d_max (or of 1 m) beyond it: solvers keep rows to 1e-7 only.
constexpr double kFelt = 1e-5;

/// By pair of cones, in both orders: whether they are too far apart to be the two far endpoints.
std::vector<bool> apart(const LaneGraphProblem& problem) {
    const std::size_t n = problem.cone_count;
    std::vector<bool> are_apart(n * n, false);
    for (const auto& [i, j] : problem.far_apart) are_apart[i * n + j] = are_apart[j * n + i] = true;
    return are_apart;
}

bool have_cone_in_common(const ProblemEdge& a, const ProblemEdge& b) {
    return a.i == b.i || a.i == b.j || a.j == b.i || a.j == b.j;
}

}  // namespace

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
    const std::size_t n = problem.cone_count;
    const double d_max = problem.parameters.d_max;
    const double felt = d_max + kFelt * std::max(1.0, d_max);
    const std::vector<bool> are_apart = apart(problem);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) {
            if (i == j) continue;
            if (rows.stop()) return;
            // Every distance above d_max has the same effect.
            double distance = std::min(problem.distance_m[i][j], kMaxDistance_m);
            // For two far cones, a tie with d_max must have the same result in a solver as in the problem.
            if (are_apart[i * n + j])
                distance = std::max(distance, felt);
            else if (!problem.near[i] && !problem.near[j])
                distance = std::min(distance, d_max);
            rows.begin({"far_distance", {static_cast<std::int32_t>(i), static_cast<std::int32_t>(j)}},
                       -kInfinity, d_max);
            if (!problem.near[i]) add_endpoint_mark(context, i, distance);
            rows.add(columns.not_far[j], -distance);
            rows.end();
        }
    }
}

// Exactly two endpoints are far, by (3) and (11). If a path ends at a far cone i with the edge {k, i}, then
// the other path ends at a far cone j within d_max of i, with an edge {l, j} that is compatible with {k, i}:
//   e_ki <= sum of e_lj over these edges.
// With pairing near_far the two paths are disjoint, so their last edges share no cone; with pairing paper the
// two ends may be those of one path.
// The relaxation is stronger than with m_i + m_j <= 1 for each pair more than d_max apart.
void far_partners(const FamilyContext& context) {
    const auto& [problem, columns, rows] = context;
    const std::size_t n = problem.cone_count;
    const std::vector<bool> are_apart = apart(problem);
    const bool disjoint = problem.parameters.pairing == Pairing::near_far;
    const ConflictGraph conflicts(problem);
    for (std::size_t i = 0; i < n; ++i) {
        if (problem.near[i]) continue;
        for (const std::size_t edge : problem.incident[i]) {
            if (rows.stop()) return;
            rows.begin({"far_partner", {static_cast<std::int32_t>(edge), static_cast<std::int32_t>(i)}},
                       -kInfinity, 0.0);
            rows.add(end_column(context, edge, i), 1.0);
            for (std::size_t j = 0; j < n; ++j) {
                if (j == i || problem.near[j] || are_apart[i * n + j]) continue;
                for (const std::size_t other : problem.incident[j]) {
                    if (conflicts.joined(edge, other)) continue;
                    if (disjoint && have_cone_in_common(problem.edges[edge], problem.edges[other])) continue;
                    rows.add(end_column(context, other, j), -1.0);
                }
            }
            rows.end();
        }
    }
}

}  // namespace conelane::constraints
