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

/// A program at one point in rational arithmetic. Every coefficient, bound and coordinate is a double, so a
/// rational number, and nothing is rounded but the differences below, once each, where they are stored.
struct ExactProgramReport {
    Rational objective;
    double objective_rounding = 0.0;  ///< of the sum in double, in the order of the columns: |it - objective|
    double row_rounding = 0.0;        ///< the largest one of a row's sum in double
    double violation = 0.0;           ///< the largest one of a row or of a column's bounds; 0: feasible
    std::string violated;             ///< the name of that row or column
    std::size_t rows = 0;
    std::size_t terms = 0;  ///< that are not 0
};

/// Precondition: a finite coordinate for each column.
[[nodiscard]] ExactProgramReport recompute_exactly(const BinaryProgram& program,
                                                   std::span<const double> point);

/// The point that a lane graph is, by the meaning of the columns' names alone (formulation.md): a_i_j,
/// f_i_j_k, g_i, u_i and e_i_j. `near` says of each cone whether it is near (11). Throws
/// std::invalid_argument where the program has a column of another family, or none for an edge of the graph.
[[nodiscard]] std::vector<double> point_of(const BinaryProgram& program, const LaneGraph& graph,
                                           const std::vector<bool>& near);

/// The program that a solver of that formulation is handed for the scene, at the lane graph. The rows that
/// are added on demand count where the lane graph violates them. Nothing where the program is too large.
/// Precondition: the graph's edges join two different cones of the scene each, none twice.
[[nodiscard]] std::optional<ExactProgramReport> recompute_exactly(const Scene& scene,
                                                                  const RldParameters& parameters,
                                                                  Formulation formulation,
                                                                  const LaneGraph& graph);

/// |exact - stated|, rounded once.
[[nodiscard]] double exact_difference(const Rational& exact, double stated);

}  // namespace conelane
