#pragma once

#include "model/binary_program.hpp"

#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace conelane {

/// Free-format MPS with the names of the labels; integer columns between INTORG and INTEND markers, all
/// bounds written out. Numbers are the shortest text that reads back as the same double. Throws InvalidInput
/// where the program has no column or two columns, or two rows, have one name.
void write_mps(std::ostream& out, const BinaryProgram& program, std::string_view name);

/// CPLEX LP format; integer columns in the section Binaries. Columns appear in their order, also those
/// without cost. A row with two finite bounds that differ becomes two, NAME_low and NAME_high. Throws like
/// write_mps, and where an integer column is not between 0 and 1.
void write_lp(std::ostream& out, const BinaryProgram& program, std::string_view name);

/// What a solver's program wrote into a solution file.
struct SolutionFile {
    enum class Status { optimal, feasible, infeasible, unknown };
    Status status = Status::unknown;
    std::vector<double> point;        ///< by column of the program; empty without one
    std::optional<double> objective;  ///< as written
};

/// Reads what `cbc FILE solve solution SOL` writes (by column name, columns at 0 left out) or what
/// `glpsol --write SOL` writes (by column number, in the order of a file that write_mps or write_lp made).
/// Throws InvalidInput whose key is "line N" where the text is neither, or speaks of columns that the program
/// does not have.
[[nodiscard]] SolutionFile read_solution_file(std::istream& in, const BinaryProgram& program);

}  // namespace conelane
