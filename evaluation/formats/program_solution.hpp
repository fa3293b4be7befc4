#pragma once

#include "model/binary_program.hpp"

#include <iosfwd>

namespace conelane {

/// The content of a solution file.
struct SolutionFile {
    enum class Status { optimal, feasible, infeasible, unknown };
    Status status = Status::unknown;
    bool states_status = false;       ///< otherwise it is feasible because there is a point
    std::vector<double> point;        ///< by column of the program; empty without a point
    std::optional<double> objective;  ///< as written
    std::optional<double> bound;      ///< as written: a lower bound of the program's optimum
    std::optional<std::int64_t> nodes;
    std::optional<double> engine_ms;  ///< the solver's own time, as written [ms]
    std::string solver;               ///< name and version, as written
};

/// Reads a solution of the program in one of these formats, recognised by the first line that is not blank:
/// - CBC: `cbc FILE solve solution SOL`, "Optimal - objective value ...", then INDEX NAME VALUE ..., also
///   with rows (`printingOptions all`); an "Optimal (within gap tolerance)" is feasible only;
/// - GLPK: `glpsol --write SOL`, lines c, s, i, j, e; by column number, in the order of a file that write_mps
///   or write_lp made;
/// - HiGHS: `highs --solution_file SOL FILE`, "Model status", its status a line later, then NAME VALUE below
///   "# Columns";
/// - SCIP: `write solution SOL`, "solution status: ...", then NAME VALUE (obj:...);
/// - MIPLIB and Gurobi: NAME VALUE, before it comments (#).
///   Such a file says nothing about optimality, so its status is feasible.
///
/// Lines =KEY= VALUE may be anywhere: =obj= VALUE and =infeas= as in MIPLIB, and for what a format cannot
/// express: =status= optimal|feasible|infeasible|unknown, which replaces the format's, =bound= VALUE, =nodes=
/// COUNT, =ms= MILLISECONDS, =solver= NAME VERSION. A file with only such lines is a solution too.
///
/// Unnamed columns are 0. Throws InvalidInput whose key is "line N" if the text has none of these formats,
/// names a column that the program does not have, a column or a key twice, has a value that is not a finite
/// number, or says two different things about status or objective. What it says is not verified: see
/// fault_of.
[[nodiscard]] SolutionFile read_solution_file(std::istream& in, const BinaryProgram& program);

/// The first thing that is wrong with a solution of the program, in words that name a column or row; empty if
/// nothing is, or if there is no point. Values have to be within their bounds, whole numbers integral (1e-5)
/// and rows kept (1e-5 of the largest term, at least of 1); the claimed objective has to be the point's, and
/// the claimed bound not above it (1e-6, of the objective if that is above 1).
[[nodiscard]] std::string fault_of(const SolutionFile& solution, const BinaryProgram& program);

}  // namespace conelane
