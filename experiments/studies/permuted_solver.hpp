#pragma once

#include "conelane/formulation.hpp"
#include "conelane/rld_solver.hpp"

#include <cstdint>
#include <memory>
#include <string_view>

namespace conelane::experiments {

/// The MILP solver of that name with rows and columns of each program in an order drawn from the seed;
/// nothing for names other than cbc, cbc-main and clp-bb. Rows that are added later keep their own order.
[[nodiscard]] std::unique_ptr<RldSolver> make_permuted_solver(std::string_view name, Formulation formulation,
                                                              std::uint64_t seed);

}  // namespace conelane::experiments
