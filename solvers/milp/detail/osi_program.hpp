#pragma once

#include "model/binary_program.hpp"
#include "solvers/milp/detail/coin_deadline.hpp"

#include <span>
#include <stdexcept>
#include <vector>

#include <coin/CoinError.hpp>
#include <coin/OsiClpSolverInterface.hpp>

namespace conelane::detail {

/// Runs `work`; an error of COIN, whose type is not std::exception, comes out as one.
template <typename Work>
void with_std_errors(Work&& work) {
    try {
        work();
    } catch (const CoinError& error) {
        throw std::runtime_error(error.className() + "::" + error.methodName() + ": " + error.message());
    }
}

/// Makes an empty solver silent and stops it by the watch, which must outlive it; and keeps Clp from taking
/// SIGINT from the program.
void prepare(OsiClpSolverInterface& solver, DeadlineWatch& watch);

/// Loads columns, rows and integrality into an empty COIN solver. Returns the integer columns, ascending.
/// Throws std::runtime_error where a cost is 1e25 or more, which Clp would end the program for.
std::vector<int> load_into(OsiSolverInterface& solver, const BinaryProgram& program);

void append_rows(OsiSolverInterface& solver, std::span<const ProgramRow> rows);

/// How far from an integer a value may be that counts as one.
inline constexpr double kIntegrality = 1e-7;

/// Whether all these columns of a point are integral.
[[nodiscard]] bool is_integral(const double* point, std::span<const int> columns);

}  // namespace conelane::detail
