#pragma once

#include "model/formulation_parts.hpp"

/// The constraint families of the RLD model; `formulation_parts.cpp` lists those of a
/// formulation. Families with many or long rows check RowWriter::stop between them.
namespace conelane::constraints {

/// The e column of paths that end with this edge at this cone.
[[nodiscard]] int end_column(const FamilyContext& context, std::size_t edge, std::size_t cone);

/// Adds coefficient * m_i to the open row: 1 if the cone is an endpoint, else 0. m_i = 2 g_i - A_i (10), or
/// the sum of its e columns if the formulation has those.
void add_endpoint_mark(const FamilyContext& context, std::size_t cone, double coefficient);

// endpoints.cpp
void inlier_degree(const FamilyContext& context);   ///< (1)(2): g_i <= A_i <= 2 g_i
void four_endpoints(const FamilyContext& context);  ///< (3)
void two_paths(const FamilyContext& context);       ///< (4), implied by (3)
void near_endpoints(const FamilyContext& context);  ///< (11)
// far_distance.cpp
void far_marks(const FamilyContext& context);     ///< (12)
void far_distance(const FamilyContext& context);  ///< (13)-(17)
void far_partners(const FamilyContext& context);  ///< (12)-(17) without u
// width.cpp
void width_pairs(const FamilyContext& context);    ///< (6)-(8)
void width_cliques(const FamilyContext& context);  ///< (6)-(8) merged into cliques
// edges.cpp
void heading(const FamilyContext& context);      ///< (9)
void edge_limits(const FamilyContext& context);  ///< (27)
void turn_limits(const FamilyContext& context);  ///< (28)
// angles.cpp
void turn_products(const FamilyContext& context);  ///< (22)(23)
void turn_flow(const FamilyContext& context);      ///< (1)(2)(22)(23)(28), tightened

/// Rows of a family that is too large to write in full: only those that an integral point violates. Pure
/// functions of the problem and the chosen edges (by problem edge).

// separated_rows.cpp
/// (5): a row for every cycle that the chosen edges form. Precondition: no cone has more than two of them.
[[nodiscard]] std::vector<ProgramRow> separate_cycles(const LaneGraphProblem& problem,
                                                      const ColumnMap& columns,
                                                      const std::vector<bool>& chosen);
/// Pairing near_far: a row for every chosen path between two near endpoints.
[[nodiscard]] std::vector<ProgramRow> separate_near_near(const LaneGraphProblem& problem,
                                                         const ColumnMap& columns,
                                                         const std::vector<bool>& chosen);

}  // namespace conelane::constraints
