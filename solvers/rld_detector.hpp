#pragma once

#include "model/lane_detector.hpp"
#include "model/rld_parameters.hpp"
#include "solvers/rld_solver.hpp"

#include <cstddef>
#include <memory>
#include <optional>

namespace conelane {

struct RldDetectorOptions {
    RldParameters parameters;
    std::optional<std::size_t> nearest;  ///< cone-set size: the nearest ahead; all cones where absent
    /// The lane is found among this many nearest cones, then cut to the cone set (see cut_to_nearest): so it
    /// goes on beyond the cones that it is answered for, as the real one does, and no false cone gains from
    /// being the last one in line. Without effect unless it is larger than `nearest`.
    std::optional<std::size_t> context;
    double absolute_gap = 1e-9;
    bool warm_start = false;  ///< start from the previous scene's lane graph, its cones found again by id
};

/// Scene to lane through an RLD solver: the lane graph of least cost is the lane. Problem and program are
/// updated for each scene, inside the time limit.
[[nodiscard]] std::unique_ptr<LaneDetector> make_rld_detector(std::unique_ptr<RldSolver> solver,
                                                              const RldDetectorOptions& options);

}  // namespace conelane
