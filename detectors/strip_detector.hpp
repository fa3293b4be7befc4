#pragma once

#include "conelane/lane_detector.hpp"
#include "model/strip_problem.hpp"
#include "solvers/strip/strip_solver.hpp"

namespace conelane {

/// A lane that costs so much more is e times less likely. Below 1, because lanes that differ in one cone may
/// both be usable; set by the FSD courses, which the costs had not seen.
inline constexpr double kStripTemperature = 0.35;

/// Where the first of some lanes, the answer, can be relied on. Each has the probability
/// exp(-cost / kStripTemperature), divided by the sum over all of them: other lanes are impossible.
struct StripTrust {
    double confidence =
        0.0;  ///< probability of the lanes that have its first 20 m; of a shorter lane, its own
    double trusted_m = 0.0;  ///< mean length of both boundaries that nearly all lanes have, by probability
};
/// Precondition: there is a lane, and each is a strip of the problem.
[[nodiscard]] StripTrust strip_trust(const StripProblem& problem, const Scene& scene,
                                     std::span<const StripLane> lanes);

/// The cheapest strip is the lane, and the cheapest ones after it say how far it is to be trusted. The time
/// limit includes making the problem.
[[nodiscard]] std::unique_ptr<LaneDetector> make_strip_detector(StripParameters parameters);

}  // namespace conelane
