#pragma once

#include "model/lane.hpp"
#include "model/rld_parameters.hpp"
#include "solvers/rld_solver.hpp"

#include <cstddef>
#include <memory>
#include <optional>

namespace conelane {

struct RldDetectorOptions {
    RldParameters parameters;
    std::optional<std::size_t> nearest;  ///< cone-set size: the nearest ahead; all cones where absent
    double absolute_gap = 1e-9;
    bool warm_start = false;  ///< start from the previous scene's lane graph, its cones found again by id
};

/// Scene to lane through an RLD solver: the lane graph of least cost is the lane. Problem and program are
/// updated for each scene, inside the time limit.
[[nodiscard]] std::unique_ptr<LaneDetector> make_rld_detector(std::unique_ptr<RldSolver> solver,
                                                              const RldDetectorOptions& options);

}  // namespace conelane
