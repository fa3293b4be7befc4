#pragma once

#include "model/binary_program.hpp"
#include "solvers/milp/detail/coin_deadline.hpp"

#include <span>
#include <stdexcept>

#include <coin/CoinError.hpp>
#include <coin/OsiClpSolverInterface.hpp>

namespace conelane::detail {

/// Runs `work`; a COIN error, which is not a std::exception, is rethrown as one.
template <typename Work>
void with_std_errors(Work&& work) {
    try {
        work();
    } catch (const CoinError& error) {
        throw std::runtime_error(error.className() + "::" + error.methodName() + ": " + error.message());
    }
}

/// Makes an empty solver silent, stops it by the watch, which must outlive it, and keeps SIGINT from Clp.
void prepare(OsiClpSolverInterface& solver, DeadlineWatch& watch);

/// Loads columns, rows and integrality into an empty COIN solver. Returns the integer columns, ascending.
/// Throws std::runtime_error for a cost of 1e14 or more, because Clp would answer wrongly.
std::vector<int> load_into(OsiSolverInterface& solver, const BinaryProgram& program);

void append_rows(OsiSolverInterface& solver, std::span<const ProgramRow> rows);

/// Tolerance of integrality.
inline constexpr double kIntegrality = 1e-7;

/// Whether all these columns of a point are integral.
[[nodiscard]] bool is_integral(const double* point, std::span<const int> columns);

}  // namespace conelane::detail
