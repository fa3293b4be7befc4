#pragma once

#include "conelane/core_solvers.hpp"
#include "model/binary_program.hpp"

#include <functional>

namespace conelane {

/// Limits of one solve of a program, see SolveLimits.
struct MilpLimits {
    double time_limit_ms = std::numeric_limits<double>::infinity();
    double absolute_gap = 1e-9;
    /// Only points with a smaller objective are of use: status infeasible then says that there are none. A
    /// backend may ignore it.
    double cutoff = std::numeric_limits<double>::infinity();
};

/// What a MILP solver answers. Absent values are unknown.
struct MilpReport {
    SolveStatus status = SolveStatus::error;
    std::optional<StopReason> stopped_by;
    std::vector<double> point;    ///< the incumbent by column; empty without an incumbent
    std::optional<double> bound;  ///< proven lower bound of the objective
    std::int64_t nodes = 0;       ///< branch-and-bound nodes; 0 if the first relaxation was integral
    std::string message;
};

/// One program loaded into a MILP solver; rows may be added between solves. Serves one thread.
class MilpSession {
  public:
    virtual ~MilpSession() = default;

    /// Solves the program with its current rows. A returned point is integral within 1e-6 on integer columns.
    [[nodiscard]] virtual MilpReport solve(const MilpLimits& limits) = 0;
    virtual void add_rows(std::span<const ProgramRow> rows) = 0;
};

/// A solver of binary programs, which never sees cones: loads a program, which has a column. `seed`: see
/// SolveArguments.
using MilpSolver =
    std::function<std::unique_ptr<MilpSession>(const BinaryProgram& program, std::uint64_t seed)>;

/// Which program a MILP solver gets.
struct ProgramForm {
    Formulation formulation = Formulation::tight;
    /// The program has every row from the first (add_connecting_flow) and is solved once. Otherwise the rows
    /// that the answer violates ((5) and the pairing) are added, and it is solved again until the answer is a
    /// lane graph.
    bool all_rows = false;
};

/// Makes an RLD solver of a MILP solver.
[[nodiscard]] std::unique_ptr<RldSolver> make_milp_rld_solver(MilpSolver solver, ProgramForm form);

/// A MILP solver of this build.
struct MilpBackend {
    RldSolverEntry entry;
    std::unique_ptr<MilpSession> (*load)(const BinaryProgram& program);
};

template <typename Session>
std::unique_ptr<MilpSession> load_session(const BinaryProgram& program) {
    return std::make_unique<Session>(program);
}

/// `Session(program)` loads a program. `entry`: all but what every backend has in common.
template <typename Session>
constexpr MilpBackend milp_backend(RldSolverEntry entry) {
    entry.traits = entry.traits | SolverTrait::exact | SolverTrait::uses_formulation;
    entry.make = [](Formulation formulation) {
        return make_milp_rld_solver(
            [](const BinaryProgram& program, std::uint64_t) { return load_session<Session>(program); },
            {.formulation = formulation});
    };
    return {entry, load_session<Session>};
}

/// Each is defined, with its properties, in the .cpp file of its name.
extern const MilpBackend kCbc;
extern const MilpBackend kCbcMain;
extern const MilpBackend kClpBb;
extern const MilpBackend kGlpk;
extern const MilpBackend kHighs;

/// Those of this build, in the order of milp_solvers.
[[nodiscard]] std::span<const MilpBackend> milp_backends();
/// The backend of that name, or nullptr if there is none.
[[nodiscard]] const MilpBackend* find_milp_backend(std::string_view name);

}  // namespace conelane
