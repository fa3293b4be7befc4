#pragma once

#include "conelane/lane_detector.hpp"
#include "graph_search/shared/parameter_field.hpp"

#include <cstdint>
#include <memory>
#include <span>

namespace conelane {

/// What a path is, what it costs, and how boundaries are read off it. Costs are relative to that of a metre
/// with no cone on one side, which is 1.
struct AstarLaneParameters {
    double least_radius_m = 4.0;      ///< of the tightest turn of a path
    double horizon_m = 25.0;          ///< length of a path
    double w_end = 1.5;               ///< cost of each metre that a path is shorter than the horizon
    double w_turn = 0.1;              ///< weight of the squared curvature, 1 at the tightest turn
    double w_steer = 0.1;             ///< weight of the squared change of curvature between two steps
    double clearance_m = 1.6;         ///< distance from cones that a path keeps where it can
    double w_clearance = 4.0;         ///< weight of the squared share of the clearance that is missing
    double w_hit = 5.0;               ///< cost of a metre that is nearer to a cone than half a car
    double window_m = 2.8;            ///< a cone so far before or behind stands beside the path
    double widest_side_m = 4.0;       ///< a cone farther to one side does not
    double expected_width_m = 4.0;    ///< between the nearest cones on both sides
    double w_width = 0.3;             ///< weight of the squared error of this width [1/m^2]
    double w_slope = 4.0;             ///< of a boundary's squared slope against the path, relative to a cone
    double heuristic = 0.2;           ///< estimated cost of a metre ahead
    std::int64_t max_steps = 10'000;  ///< expanded by the search, in [1, 1000000]
};

/// The numbers that are tuned, in the order of files.
[[nodiscard]] std::span<const ParameterField<AstarLaneParameters>> astar_lane_fields();

/// Throws InvalidInput naming the first parameter that is out of its range.
void validate(const AstarLaneParameters& parameters);

/// Lane detection by path planning, after Tanzmeister, Friedl, Lawitzky, Wollherr and Buss, "Road course
/// estimation in unknown, structured environments" (2013), reference [2] of the CLC paper: not the boundaries
/// are searched but a path inside of them, by A* over arcs of bounded curvature from the car's pose on
/// (a lattice of positions, headings and lengths). Cones are obstacles that a path keeps away from; to hit
/// one costs much but is not forbidden, for it may be a false detection. A metre with cones on both sides,
/// about a lane apart, costs least. The boundaries are then read off the path: on each side the chain of
/// cones that runs along it most evenly.
///
/// The cheapest path counts whose boundaries have two cones at least; paths are taken in the order of their
/// costs, exactly where `heuristic` underestimates. LaneAnswer::status: `none` where fewer than four places
/// have a cone in reach, or every path of the lattice was seen; `stopped` by iterations where none of the
/// paths seen has boundaries. A lane whose search was cut off by a limit is that of the best path until then.
/// Nothing is carried from scene to scene. Throws InvalidInput where a parameter is out of its range.
[[nodiscard]] std::unique_ptr<LaneDetector> make_astar_lane_detector(const AstarLaneParameters& parameters);

}  // namespace conelane
