#pragma once

#include "model/binary_program.hpp"

#include <span>
#include <vector>

#include <coin/OsiSolverInterface.hpp>

namespace conelane::detail {

/// Loads columns, rows and integrality into an empty COIN solver. Returns the integer columns, ascending.
std::vector<int> load_into(OsiSolverInterface& solver, const BinaryProgram& program);

void append_rows(OsiSolverInterface& solver, std::span<const ProgramRow> rows);

/// How far from an integer a value may be that counts as one.
inline constexpr double kIntegrality = 1e-7;

/// Whether all these columns of a point are integral.
[[nodiscard]] bool is_integral(const double* point, std::span<const int> columns);

}  // namespace conelane::detail
