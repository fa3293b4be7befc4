#pragma once

#include "conelane/lane_detector.hpp"
#include "conelane/rld_parameters.hpp"
#include "conelane/rld_solver.hpp"

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

namespace conelane {

/// The cones that an RLD detector answers for, and the cones that it looks at.
struct ConeSet {
    std::optional<std::size_t> nearest;  ///< this many nearest cones ahead; all cones if absent
    /// The lane is found among this many nearest cones, then cut to the cone set (see cut_to_nearest). So it
    /// goes on beyond the cone set, as the real lane does, and a false cone does not gain from being the last
    /// one in line. Has an effect only if it is larger than `nearest`.
    std::optional<std::size_t> context;

    /// Whether lanes are cut.
    [[nodiscard]] bool has_context() const;
    /// The scene restricted to the cones that the solver sees.
    [[nodiscard]] Scene seen(const Scene& scene) const;
    bool operator==(const ConeSet&) const = default;
};

struct RldDetectorOptions {
    RldParameters parameters;    ///< of the objective
    ConeSet cones;               ///< all cones by default
    double absolute_gap = 1e-9;  ///< see SolveLimits
    bool warm_start = false;     ///< start from the previous scene's lane graph, its cones found again by id
    /// Values of d_near to try, in this order, where no lane graph is feasible [m]: a first cone may be
    /// beyond d_near, and all cones of a short view may be within. An answer by one of them makes no
    /// statement about its optimality, and its message says so. A limit that ends a try ends the search.
    std::vector<double> other_d_near_m = {};
};

/// A detector of an RLD solver: the lane graph of least cost is the lane. The time limit includes making
/// problem and program. If a lane found among the context has no cone of the cone set on one side, the cone
/// set is solved by itself, so status none is always about the cone set.
[[nodiscard]] std::unique_ptr<LaneDetector> make_rld_detector(std::unique_ptr<RldSolver> solver,
                                                              const RldDetectorOptions& options);

}  // namespace conelane
