#pragma once

#include "conelane/formulation.hpp"
#include "conelane/lane_graph_problem.hpp"
#include "model/binary_program.hpp"

#include <array>

namespace conelane {

/// Columns of the variables of a problem in its program; -1 for a variable that is left out.
struct ColumnMap {
    std::vector<int> edge;     ///< a_ij by problem edge
    std::vector<int> turn;     ///< f_ijk by problem turn
    std::vector<int> inlier;   ///< g_i by cone
    std::vector<int> not_far;  ///< u_i by cone
    /// e_ij and e_ji by problem edge {i, j}, i < j: a path ends at its first and at its second cone by it
    std::vector<std::array<int, 2>> end;
};

/// The arguments of a constraint family.
struct FamilyContext {
    const LaneGraphProblem& problem;
    const ColumnMap& columns;
    RowWriter& rows;
};
using ConstraintFamily = void (*)(const FamilyContext&);

/// A formulation as a list of parts.
struct FormulationParts {
    EdgeExtent extent;
    bool high_cost_turns = false;  ///< f columns also for forbidden turns
    bool inliers = false;          ///< g columns
    bool far_marks = false;        ///< u columns
    bool path_ends = false;        ///< e columns
    bool all_integer = false;
    /// Families whose rows depend only on the number of cones. Their rows come first.
    std::span<const ConstraintFamily> fixed_families = {};
    std::span<const ConstraintFamily> families;  ///< the other families
};
[[nodiscard]] const FormulationParts& parts(Formulation formulation);

}  // namespace conelane
