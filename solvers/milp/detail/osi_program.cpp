#include "solvers/milp/detail/osi_program.hpp"

#include <cmath>

#include <coin/ClpSimplex.hpp>
#include <coin/ClpSolve.hpp>
#include <coin/CoinPackedMatrix.hpp>
#include <coin/CoinPackedVector.hpp>

namespace conelane::detail {
namespace {

double coin_lower(double bound) {
    return bound <= -kInfinity ? -COIN_DBL_MAX : bound;
}
double coin_upper(double bound) {
    return bound >= kInfinity ? COIN_DBL_MAX : bound;
}

/// From about 1e15, Clp calls programs infeasible that are not; above 1e25 it ends the process.
constexpr double kClpMostCost = 1e14;

}  // namespace

void prepare(OsiClpSolverInterface& solver, DeadlineWatch& watch) {
    solver.messageHandler()->setLogLevel(0);
    ClpSimplex& lp = *solver.getModelPtr();
    lp.setLogLevel(0);
    const ClpDeadline handler(&watch);
    lp.passInEventHandler(&handler);
    constexpr int kInterrupt = 2;  // at 1, initialSolve would install a handler of SIGINT
    ClpSolve options;
    options.setSpecialOption(kInterrupt, 1);
    solver.setSolveOptions(options);
}

std::vector<int> load_into(OsiSolverInterface& solver, const BinaryProgram& program) {
    const std::size_t columns = program.columns.size();
    const std::size_t rows = program.rows.size();
    std::vector<int> integers;
    std::vector<double> lower(columns), upper(columns), costs(columns);
    for (std::size_t c = 0; c < columns; ++c) {
        if (!(std::abs(program.columns[c].objective) < kClpMostCost))
            throw std::runtime_error("the cost of column " + to_string(program.columns[c].label) +
                                     " is too large for Clp");
        lower[c] = program.columns[c].lower;
        upper[c] = program.columns[c].upper;
        costs[c] = program.columns[c].objective;
        if (program.columns[c].integer) integers.push_back(static_cast<int>(c));
    }
    std::vector<double> row_lower(rows), row_upper(rows);
    for (std::size_t r = 0; r < rows; ++r) {
        row_lower[r] = coin_lower(program.rows[r].lower);
        row_upper[r] = coin_upper(program.rows[r].upper);
    }
    const CoinPackedMatrix matrix(false, static_cast<int>(columns), static_cast<int>(rows),
                                  static_cast<int>(program.entry_values.size()), program.entry_values.data(),
                                  program.entry_columns.data(), program.row_starts.data(), nullptr);
    solver.loadProblem(matrix, lower.data(), upper.data(), costs.data(), row_lower.data(), row_upper.data());
    for (const int column : integers) solver.setInteger(column);
    return integers;
}

void append_rows(OsiSolverInterface& solver, std::span<const ProgramRow> rows) {
    for (const ProgramRow& row : rows) {
        CoinPackedVector terms;
        for (const auto& [column, coefficient] : row.terms) terms.insert(column, coefficient);
        solver.addRow(terms, coin_lower(row.lower), coin_upper(row.upper));
    }
}

bool is_integral(const double* point, std::span<const int> columns) {
    return std::ranges::all_of(
        columns, [&](int c) { return std::abs(point[c] - std::round(point[c])) <= kIntegrality; });
}

}  // namespace conelane::detail
