#pragma once

#include "evaluation/world/track.hpp"

namespace conelane {

/// Longest boundary that centre_line_poses takes [m]; its matching takes time and memory quadratic in it.
inline constexpr double kMaxBoundary_m = 5000.0;
/// Shortest travel between two poses [m].
inline constexpr double kMinEvery_m = 0.01;

/// The poses of a car that drives the centre line of a track, one every `every_m` metres of travel, heading
/// along it. Both boundaries are matched monotonically with the least sum of squared widths (dynamic time
/// warping); the midpoints of matched places, smoothed over 3 m, are the centre line.
///
/// A closed course is driven once, from its first left cone on; left and right boundary may start at
/// different places. An open course is driven from where both boundaries have begun to where the first of
/// them ends. Positions are multiples of 1e-6 m, yaws in [-pi, pi] of 1e-9 rad.
///
/// Throws InvalidInput if `every_m` is not finite or below kMinEvery_m (key `every_m`), or a boundary has
/// fewer than two cones (three on a closed course), no length, or more than kMaxBoundary_m (`left`, `right`).
[[nodiscard]] std::vector<Pose> centre_line_poses(const TrackBoundaries& boundaries, double every_m);

/// Indices of positions on the left and on the right boundary that face each other.
struct FacingPlaces {
    std::size_t left;
    std::size_t right;
};

/// The monotone matching of two densely sampled boundaries with the least sum of squared distances between
/// matched positions (symmetric dynamic time warping: a step on both sides counts as one on each). Every
/// position is matched at least once, from the first pair to the last. Of equally good steps, one on both
/// sides comes first, then one on the left. Takes one byte for each pair of positions. Precondition: neither
/// boundary is empty.
[[nodiscard]] std::vector<FacingPlaces> match_boundaries(std::span<const Point> left,
                                                         std::span<const Point> right);

}  // namespace conelane
