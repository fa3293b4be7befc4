#include "solvers/relaxation/linear_relaxation.hpp"

#include "solvers/milp/detail/osi_program.hpp"

#include <cmath>
#include <vector>

#include <coin/OsiClpSolverInterface.hpp>

namespace conelane {
namespace {

constexpr double kSame = 1e-7;
constexpr int kBasic = 1;  // as getBasisStatus returns it

bool is_same(double a, double b) {
    return std::abs(a - b) <= kSame;
}

/// Whether the value of a basic column or row is at one of its bounds.
std::size_t count_at_bounds(const std::vector<int>& status, const double* value, const double* lower,
                            const double* upper) {
    std::size_t count = 0;
    for (std::size_t k = 0; k < status.size(); ++k) {
        if (status[k] == kBasic && (is_same(value[k], lower[k]) || is_same(value[k], upper[k]))) ++count;
    }
    return count;
}

void load_silently(OsiClpSolverInterface& lp, const BinaryProgram& program) {
    lp.messageHandler()->setLogLevel(0);
    lp.getModelPtr()->setLogLevel(0);
    detail::load_into(lp, program);
}

}  // namespace

std::optional<double> linear_relaxation_optimum(const BinaryProgram& program) {
    OsiClpSolverInterface lp;
    load_silently(lp, program);
    lp.initialSolve();
    if (!lp.isProvenOptimal()) return std::nullopt;
    return lp.getObjValue();
}

std::optional<RelaxationShape> relaxation_shape(const BinaryProgram& program) {
    OsiClpSolverInterface lp;
    load_silently(lp, program);
    lp.initialSolve();
    if (!lp.isProvenOptimal()) return std::nullopt;
    RelaxationShape shape;
    shape.optimum = lp.getObjValue();
    std::vector<int> columns(program.columns.size());
    std::vector<int> rows(program.rows.size());
    lp.getBasisStatus(columns.data(), rows.data());
    shape.degenerate = count_at_bounds(columns, lp.getColSolution(), lp.getColLower(), lp.getColUpper()) +
                       count_at_bounds(rows, lp.getRowActivity(), lp.getRowLower(), lp.getRowUpper());
    for (std::size_t c = 0; c < columns.size(); ++c) {
        const double value = lp.getColSolution()[c];
        if (program.columns[c].integer && !is_same(value, std::round(value))) ++shape.fractional;
        const bool is_fixed = program.columns[c].lower == program.columns[c].upper;
        if (columns[c] != kBasic && !is_fixed && is_same(lp.getReducedCost()[c], 0.0))
            ++shape.dual_degenerate;
    }
    return shape;
}

}  // namespace conelane
