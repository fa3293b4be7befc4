#pragma once

#include "conelane/lane_detector.hpp"
#include "conelane/rld_parameters.hpp"
#include "conelane/rld_solver.hpp"

#include <cstddef>
#include <memory>
#include <optional>

namespace conelane {

/// Which cones an RLD detector answers for, and which it looks at.
struct ConeSet {
    std::optional<std::size_t> nearest;  ///< so many, the nearest ahead; all cones where absent
    /// The lane is found among this many nearest cones, then cut to the cone set (see cut_to_nearest): so it
    /// goes on beyond the cones that it is answered for, as the real one does, and no false cone gains from
    /// being the last one in line. Without effect unless it is larger than `nearest`.
    std::optional<std::size_t> context;

    /// Whether lanes are cut.
    [[nodiscard]] bool has_context() const;
    /// The scene restricted to the cones that the solver sees.
    [[nodiscard]] Scene seen(const Scene& scene) const;
    bool operator==(const ConeSet&) const = default;
};

struct RldDetectorOptions {
    RldParameters parameters;
    ConeSet cones;
    double absolute_gap = 1e-9;
    bool warm_start = false;  ///< start from the previous scene's lane graph, its cones found again by id
};

/// Scene to lane through an RLD solver: the lane graph of least cost is the lane. Problem and program are
/// updated for each scene, inside the time limit. Where a lane that was found among the context has no cone
/// of the cone set on one side, the cone set is solved by itself: status none is always about it.
[[nodiscard]] std::unique_ptr<LaneDetector> make_rld_detector(std::unique_ptr<RldSolver> solver,
                                                              const RldDetectorOptions& options);

}  // namespace conelane
