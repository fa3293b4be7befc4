#pragma once

#include "model/binary_program.hpp"

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace conelane {

/// The content of a solution file.
struct SolutionFile {
    enum class Status { optimal, feasible, infeasible, unknown };
    Status status = Status::unknown;
    std::vector<double> point;        ///< by column of the program; empty without a point
    std::optional<double> objective;  ///< as written
    std::optional<double> bound;      ///< as written: a lower bound of the program's optimum
    std::optional<std::int64_t> nodes;
    std::optional<double> engine_ms;  ///< the solver's own time, as written [ms]
    std::string solver;               ///< name and version, as written
};

/// Reads a solution of the program in one of these formats, recognised by the first line that is not blank:
/// - CBC: `cbc FILE solve solution SOL`, "Optimal - objective value ...", then INDEX NAME VALUE ...;
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
/// names a column that the program does not have or a column twice, or has a value that is not a finite
/// number.
[[nodiscard]] SolutionFile read_solution_file(std::istream& in, const BinaryProgram& program);

}  // namespace conelane
