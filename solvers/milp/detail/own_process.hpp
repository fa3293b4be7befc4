#pragma once

#include "solvers/milp/milp_solver.hpp"

namespace conelane::detail {

/// Runs `work` in a copy of this process, for a library whose failed assertions end the process. If the copy
/// ends without an answer, the report is an error with the last line of its standard error. An exception of
/// `work` is one too, except std::bad_alloc, which is thrown here. Nothing else that `work` changes is seen
/// by the caller. Of a program with threads the copy has this one alone: `work` may wait for no other and
/// start none.
[[nodiscard]] MilpReport in_own_process(const std::function<MilpReport()>& work);

}  // namespace conelane::detail
