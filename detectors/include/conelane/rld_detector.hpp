#pragma once

#include "conelane/lane_detector.hpp"
#include "conelane/rld_parameters.hpp"
#include "conelane/rld_solver.hpp"

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

namespace conelane {

/// The cones that the lane of an RLD detector may have, and the cones among which it is searched.
struct ConeSet {
    std::optional<std::size_t> nearest;  ///< this many nearest cones ahead; all cones if absent
    /// The lane is searched among this many nearest cones, then cut to the cone set (see cut_to_nearest). So
    /// a false cone at the far end of the cone set has rivals beyond it. Only if `nearest` is given and
    /// smaller.
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
    bool warm_start = false;     ///< start from the last lane graph that was found, its cones found by id
    /// Values of d_near [m] to try, in this order, if no lane graph is feasible: the first cone may be
    /// farther away than d_near, or all cones of a short view may be nearer. A lane by one of these values
    /// claims no optimality, and its message says that another d_near was used. If a limit or an error ends
    /// one of the searches, no other one begins.
    std::vector<double> other_d_near_m = {};
};

/// A detector by an RLD solver: the lane graph of least cost is the lane. The time limit includes making
/// problem and program. If the cut lane has no cone on one side, the cone set is solved by itself. Status
/// none says that these cones have no lane graph by any of the values of d_near.
[[nodiscard]] std::unique_ptr<LaneDetector> make_rld_detector(std::unique_ptr<RldSolver> solver,
                                                              const RldDetectorOptions& options);

}  // namespace conelane
