#pragma once

#include "graph_search/baselines/astar_lane/astar_lane_detector.hpp"
#include "graph_search/baselines/delaunay_beam/delaunay_beam_detector.hpp"

namespace conelane {

/// The shipped parameters of delaunay-beam and astar-lane, from parameters/NAME.json.
/// parameters/NAME.record.json has the scenes on which `conelane tune --method` found them.
[[nodiscard]] DelaunayBeamParameters tuned_delaunay_beam_parameters();
[[nodiscard]] AstarLaneParameters tuned_astar_lane_parameters();

}  // namespace conelane
