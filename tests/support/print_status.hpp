#pragma once

#include "conelane/solve_report.hpp"

#include <ostream>

namespace conelane {

/// For GoogleTest, which would print bytes.
inline void PrintTo(SolveStatus status, std::ostream* out) {
    *out << to_string(status);
}
inline void PrintTo(StopReason reason, std::ostream* out) {
    *out << to_string(reason);
}

}  // namespace conelane
