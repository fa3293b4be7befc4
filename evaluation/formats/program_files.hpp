#pragma once

#include "model/binary_program.hpp"

#include <iosfwd>

namespace conelane {

/// Free-format MPS with the names of the labels; integer columns between INTORG and INTEND markers, all
/// bounds written out. Numbers are the shortest text that reads back as the same double. Throws InvalidInput
/// if the program has no column, or two columns or two rows have the same name.
void write_mps(std::ostream& out, const BinaryProgram& program, std::string_view name);

/// CPLEX LP format; integer columns in the section Binaries. Columns appear in their order, also those
/// without cost. A row with two finite bounds that differ becomes two, NAME_low and NAME_high. Throws like
/// write_mps, and if an integer column is not between 0 and 1.
void write_lp(std::ostream& out, const BinaryProgram& program, std::string_view name);

}  // namespace conelane
