#pragma once

#include "model/binary_program.hpp"

#include <cstddef>
#include <optional>

namespace conelane {

/// Optimum of the program without integrality, by Clp; nothing if it is infeasible. Precondition: the program
/// has a column.
[[nodiscard]] std::optional<double> linear_relaxation_optimum(const BinaryProgram& program);

/// The optimum of a program without integrality, and its degeneracy.
struct RelaxationShape {
    double optimum = 0.0;
    std::size_t fractional = 0;  ///< number of integer columns with a fractional value
    /// Of the basic columns and rows (as many as there are rows), those at one of their bounds.
    std::size_t degenerate = 0;
    /// Of the columns that are not basic and not fixed, those of reduced cost 0: other optima are likely.
    std::size_t dual_degenerate = 0;
};
/// By Clp's dual simplex; nothing if it is infeasible. Values count as equal within 1e-7. Precondition: the
/// program has a column.
[[nodiscard]] std::optional<RelaxationShape> relaxation_shape(const BinaryProgram& program);

}  // namespace conelane
