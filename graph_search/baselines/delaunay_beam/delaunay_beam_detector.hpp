#pragma once

#include "conelane/lane_detector.hpp"
#include "graph_search/shared/parameter_field.hpp"

#include <cstddef>
#include <memory>
#include <numbers>
#include <span>

namespace conelane {

/// What a path costs, relative to the squared relative error of its length, and how far the tree of paths
/// reaches. The paper prints no values.
struct DelaunayBeamParameters {
    double w_turn = 0.2;          ///< weight of the squared largest turn [1/rad^2]
    double w_width_spread = 0.2;  ///< weight of the variance of the track width [1/m^2]
    double w_width = 0.1;         ///< weight of the squared error of the mean width [1/m^2]
    double w_spacing = 0.05;      ///< weight of the mean variance of both boundaries' spacing [1/m^2]
    double w_start = 0.01;        ///< weight of the squared distance to the first middle point [1/m^2]
    double expected_width_m = 4.0;
    double expected_length_m = 25.0;  ///< of the path; no path grows beyond it
    double widest_m = 7.0;            ///< longest edge that a path crosses
    double longest_spacing_m = 6.5;   ///< longest edge of a boundary
    double start_radius_m = 7.0;      ///< farthest middle point that a path may begin with

    // Not tuned: scenes are scored without colors, and a wider beam only takes longer.
    /// Weight of the mean probability that a cone has the color of the other side, in [0, 1000].
    double w_color = 1.0;
    /// Paths kept at each depth of the tree, in [1, 10000].
    std::size_t beam_width = 100;
};

/// The numbers that are tuned, in the order of files.
[[nodiscard]] std::span<const ParameterField<DelaunayBeamParameters>> delaunay_beam_fields();

/// Throws InvalidInput naming the first parameter that is out of its range.
void validate(const DelaunayBeamParameters& parameters);

/// The boundary estimation of the AMZ team (Kabzan et al., "AMZ Driverless: The Full Autonomous Racing
/// System", reference [4] of the CLC paper): the cones are triangulated (Delaunay), and from the car on a
/// tree of paths grows through the middle points of the edges, from triangle to triangle. The two ends of an
/// edge crossed are the boundaries' cones there, so with each triangle one boundary goes on by one cone. Of
/// each depth only the paths of the lowest cost stay (beam search), and the answer is the path of the lowest
/// cost of all: one that turns little, whose width and spacings vary little, that is about as long as the
/// expected range and, where colors are known, has few cones of the wrong color. None of this is a
/// constraint.
///
/// Two terms are added to the paper's: the error of the mean width (the competition's rules give it) and the
/// distance to the first middle point, since the car seldom stands inside a triangle of the cones ahead.
///
/// A lane has two cones a side at least, each cone at most once. LaneAnswer::status: `none` where no path of
/// the whole tree is one; `stopped` by iterations where none was found, but the beam left paths out. Nothing
/// is carried from scene to scene. Throws InvalidInput where a parameter is out of its range.
[[nodiscard]] std::unique_ptr<LaneDetector> make_delaunay_beam_detector(
    const DelaunayBeamParameters& parameters);

}  // namespace conelane
