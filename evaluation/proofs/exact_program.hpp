#pragma once

#include "conelane/formulation.hpp"
#include "conelane/lane_graph.hpp"
#include "conelane/rld_parameters.hpp"
#include "model/binary_program.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <boost/multiprecision/cpp_int.hpp>

namespace conelane {

using Rational = boost::multiprecision::cpp_rational;

/// A program at one point in rational arithmetic. Every coefficient, bound and coordinate is a double, hence
/// a rational number. Only the differences below are rounded, once each, when they are stored.
struct ExactProgramReport {
    Rational objective;
    double objective_rounding =
        0.0;                    ///< rounding of the objective's sum in double, in the order of the columns
    double row_rounding = 0.0;  ///< largest rounding of a row's sum in double
    double violation = 0.0;     ///< largest violation of a row or of a column's bounds; 0: feasible
    std::string violated;       ///< the name of that row or column
    std::size_t rows = 0;
    std::size_t terms = 0;  ///< number of terms that are not 0
};

/// Precondition: a finite coordinate for each column.
[[nodiscard]] ExactProgramReport recompute_exactly(const BinaryProgram& program,
                                                   std::span<const double> point);

/// The point of a lane graph, by the meaning of the columns' names (formulation.md): a_i_j, f_i_j_k, g_i, u_i
/// and e_i_j. `near` tells for each cone whether it is near (11). Throws std::invalid_argument if the program
/// has a column of another family, or no column for an edge of the graph.
[[nodiscard]] std::vector<double> point_of(const BinaryProgram& program, const LaneGraph& graph,
                                           const std::vector<bool>& near);

/// The program of that formulation for the scene, at the lane graph. Rows that are added on demand count if
/// the lane graph violates them. Nothing if the program is too large. Precondition: each edge of the graph
/// joins two different cones of the scene, and none occurs twice.
[[nodiscard]] std::optional<ExactProgramReport> recompute_exactly(const Scene& scene,
                                                                  const RldParameters& parameters,
                                                                  Formulation formulation,
                                                                  const LaneGraph& graph);

/// |exact - stated|, rounded once.
[[nodiscard]] double exact_difference(const Rational& exact, double stated);

}  // namespace conelane
