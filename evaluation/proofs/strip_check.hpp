#pragma once

#include "conelane/check.hpp"
#include "model/strip_problem.hpp"

namespace conelane {

/// Recomputes the strip of a lane from the scene alone: limits, the cheapest triangles between the boundaries
/// and the cost of every column. Shares no code with the builder of the problem, its features and the search.
/// `objective`: the lane's cost, if it is a strip. With a claim, also what the claim says of it.
[[nodiscard]] CheckReport check_strip(const Scene& scene, const StripParameters& parameters, const Lane& lane,
                                      const std::optional<Claim>& claim = {});

}  // namespace conelane
