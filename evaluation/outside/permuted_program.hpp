#pragma once

#include "model/binary_program.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace conelane {

/// A program whose rows and columns stand in another order. It is the same program, and its labels are the
/// same; what a solver makes of it may differ.
struct PermutedProgram {
    BinaryProgram program;
    std::vector<std::size_t> column_of;  ///< the place in `program` of each column of the first program

    /// The point of the first program that a point of `program` stands for. Empty from an empty one.
    [[nodiscard]] std::vector<double> point_of(std::span<const double> point) const;
};

/// Rows and columns in orders that are drawn from the seed; the entries of a row are in the new order of
/// columns. The same seed gives the same order on any machine.
[[nodiscard]] PermutedProgram permuted(const BinaryProgram& program, std::uint64_t seed);

}  // namespace conelane
