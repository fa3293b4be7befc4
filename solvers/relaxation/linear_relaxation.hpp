#pragma once

#include "model/binary_program.hpp"

#include <optional>

namespace conelane {

/// Optimum of the program without integrality, by Clp; nothing if it is infeasible. Precondition: the program
/// has a column.
[[nodiscard]] std::optional<double> linear_relaxation_optimum(const BinaryProgram& program);

}  // namespace conelane
