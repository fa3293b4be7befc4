#pragma once

#include "graph_search/baselines/astar_lane/astar_lane_detector.hpp"
#include "graph_search/baselines/delaunay_beam/delaunay_beam_detector.hpp"

namespace conelane {

/// The parameters that delaunay-beam and astar-lane are shipped with, of parameters/NAME.json;
/// parameters/NAME.record.json says on which scenes `conelane tune-method` found them.
[[nodiscard]] DelaunayBeamParameters tuned_delaunay_beam_parameters();
[[nodiscard]] AstarLaneParameters tuned_astar_lane_parameters();

}  // namespace conelane
