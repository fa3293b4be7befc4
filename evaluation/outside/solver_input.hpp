#pragma once

#include "model/binary_program.hpp"
#include "model/connecting_flow.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace conelane {

/// A program with rows and columns in another order. It is the same program with the same labels; a solver
/// may treat it differently.
struct PermutedProgram {
    BinaryProgram program;
    std::vector<std::size_t> column_of;  ///< the position in `program` of each column of the first program

    /// The point of the first program for a point of `program`. Empty for an empty point.
    [[nodiscard]] std::vector<double> point_of(std::span<const double> point) const;
};

/// Random orders of rows and columns; the entries of a row follow the new order of columns. The same seed
/// gives the same order on any machine.
[[nodiscard]] PermutedProgram permuted(const BinaryProgram& program, std::uint64_t seed);

}  // namespace conelane
