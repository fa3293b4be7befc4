#pragma once

#include "model/binary_program.hpp"

#include <optional>

namespace conelane {

struct LinearRelaxation {
    double optimum;
    bool is_integral;  ///< no integer column has a fractional value
};

/// The optimum of the program without integrality, by Clp; nothing if it is infeasible. Precondition: the
/// program has a column.
[[nodiscard]] std::optional<LinearRelaxation> linear_relaxation(const BinaryProgram& program);

}  // namespace conelane
