#pragma once

#include "conelane/solve_report.hpp"
#include "model/binary_program.hpp"

#include <limits>
#include <memory>
#include <span>

namespace conelane {

/// Limits of one solve of a program, see SolveLimits.
struct MilpLimits {
    double time_limit_ms = std::numeric_limits<double>::infinity();
    double absolute_gap = 1e-9;
    /// Only points with a smaller objective are of use: status infeasible then says that there are none. A
    /// backend may ignore it.
    double cutoff = std::numeric_limits<double>::infinity();
};

/// One program loaded into a MILP solver; rows may be added between solves. Serves one thread.
class MilpSession {
  public:
    virtual ~MilpSession() = default;

    /// Solves the program with its current rows. A returned point is integral within 1e-6 on integer columns.
    [[nodiscard]] virtual MilpReport solve(const MilpLimits& limits) = 0;
    virtual void add_rows(std::span<const ProgramRow> rows) = 0;
};

/// A solver of binary programs; it never sees cones.
class MilpSolver {
  public:
    virtual ~MilpSolver() = default;
    /// Precondition: the program has a column.
    [[nodiscard]] virtual std::unique_ptr<MilpSession> load(const BinaryProgram& program) const = 0;
};

}  // namespace conelane
