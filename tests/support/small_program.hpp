#pragma once

#include "model/binary_program.hpp"

namespace conelane::tests {

/// minimise x - 2 y, x + y <= 1, 0 <= y - z <= 0.5 with x, y binary and z in [0, 0.75].
inline BinaryProgram small_program() {
    BinaryProgram program;
    const int x = program.add_column({"x"}, 1.0, true);
    const int y = program.add_column({"y", {1}}, -2.0, true);
    const int z = program.add_column({"z", {1, 2}}, 0.0, false, 0.0, 0.75);
    RowWriter rows(program);
    rows.begin({"one_of"}, -kInfinity, 1.0);
    rows.add(x, 1.0);
    rows.add(y, 1.0);
    rows.end();
    rows.begin({"close", {0}}, 0.0, 0.5);
    rows.add(y, 1.0);
    rows.add(z, -1.0);
    rows.end();
    return program;
}

}  // namespace conelane::tests
