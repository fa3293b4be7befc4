#pragma once

#include "conelane/lane_detector.hpp"
#include "graph_search/shared/parameter_field.hpp"

#include <cstddef>
#include <memory>
#include <span>

namespace conelane {

/// The cost of a path, relative to the squared relative error of its length, and the limits of the tree of
/// paths. The paper prints no values.
struct DelaunayBeamParameters {
    double w_turn = 0.2;          ///< weight of the squared largest turn [1/rad^2]
    double w_width_spread = 0.2;  ///< weight of the variance of the track width [1/m^2]
    double w_width = 0.1;         ///< weight of the squared error of the mean width [1/m^2]
    double w_spacing = 0.05;      ///< weight of the mean variance of both boundaries' spacing [1/m^2]
    double w_start = 0.01;        ///< weight of the squared distance to the first middle point [1/m^2]
    double expected_width_m = 4.0;
    double expected_length_m = 25.0;  ///< expected length of the path; no path is longer
    double widest_m = 7.0;            ///< longest edge that a path crosses
    double longest_spacing_m = 6.5;   ///< longest edge of a boundary
    double start_radius_m = 7.0;      ///< largest distance of the first middle point of a path

    // Not tuned: scenes are scored without colors, and a wider beam only takes longer.
    /// Weight of the mean probability that a cone has the color of the other side, in [0, 1000].
    double w_color = 1.0;
    /// Paths kept at each depth of the tree, in [1, 10000].
    std::size_t beam_width = 100;
};

/// The tuned numbers, in the order of files.
[[nodiscard]] std::span<const ParameterField<DelaunayBeamParameters>> delaunay_beam_fields();

/// Throws InvalidInput naming the first parameter that is out of its range.
void validate(const DelaunayBeamParameters& parameters);

/// The boundary estimation of the AMZ team (Kabzan et al., "AMZ Driverless: The Full Autonomous Racing
/// System", reference [4] of the CLC paper). The cones are triangulated (Delaunay). From the car on, a tree
/// of paths grows through the middle points of the edges, from triangle to triangle. The two ends of a
/// crossed edge are the cones of the boundaries there, so each triangle extends one boundary by one cone. At
/// each depth only the paths of the lowest cost are kept (beam search). The answer is the path of the lowest
/// cost of all: it turns little, its width and spacings vary little, its length is near the expected range
/// and, if colors are known, few of its cones have the wrong color. None of this is a constraint.
///
/// Two terms are added to the paper's: the error of the mean width (from the rules of the competition) and
/// the distance to the first middle point, since the car is seldom inside a triangle of the cones ahead.
///
/// A lane has at least two cones a side, each cone at most once. LaneAnswer::status: `none` if no path of the
/// whole tree is a lane; `stopped` by iterations if no lane was found but the beam left paths out. No state
/// is kept from scene to scene. Throws InvalidInput if a parameter is out of its range.
[[nodiscard]] std::unique_ptr<LaneDetector> make_delaunay_beam_detector(
    const DelaunayBeamParameters& parameters);

}  // namespace conelane
