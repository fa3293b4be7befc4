#pragma once

#include "conelane/scene.hpp"
#include "model/geometry.hpp"

#include <filesystem>
#include <map>

namespace conelane {

/// The whole annotated boundaries of a track in driving order, for the centre line and for divergence.
struct TrackBoundaries {
    std::vector<Point> left;
    std::vector<Point> right;
    bool closed = true;
    /// The driven path of a run without annotated boundaries, which are then empty.
    std::vector<Point> driven = {};
};

using TrackBoundariesByName = std::map<std::string, TrackBoundaries>;

/// Position of a cone on the map of one moment.
struct MapPlace {
    std::size_t cone = 0;
    Point position;
};

/// Pose and map of a car at one moment of a recorded run.
struct RunFrame {
    Pose pose;
    double travelled_m = 0.0;
    std::vector<MapPlace> map;
};

/// A map of cones with annotated boundaries. Indices refer to `cones`; cones that belong to no boundary are
/// false positives of the recording and stay visible.
struct Track {
    std::string name;                ///< as scene ids and result tables show it, such as "fsd_1"
    std::vector<Cone> cones;         ///< ids of the source if it has any, else the index
    std::vector<std::size_t> left;   ///< driving order
    std::vector<std::size_t> right;  ///< driving order
    bool closed = true;
    /// Frames of a recorded run, in order; then `cones` are all cones that its maps ever held, at their last
    /// places.
    std::vector<RunFrame> frames{};
    std::vector<Point> driven{};  ///< the path of a run without boundaries
    std::vector<std::string>
        warnings{};  ///< facts about the recording that a user should know, a sentence each
};

/// The annotated boundaries as polylines.
[[nodiscard]] inline TrackBoundaries boundaries(const Track& track) {
    TrackBoundaries lines{.left = {}, .right = {}, .closed = track.closed, .driven = track.driven};
    for (const std::size_t index : track.left) lines.left.push_back(track.cones[index].position);
    for (const std::size_t index : track.right) lines.right.push_back(track.cones[index].position);
    return lines;
}

/// Why `coordinate_m` is invalid for a cone (not finite, or beyond 10^7 m); empty if it is valid.
[[nodiscard]] std::string coordinate_fault(double coordinate_m);

/// Throws InputError naming `left` or `right` if a boundary has too few cones: a closed course needs three,
/// an open one two.
void require_enough_cones(const Track& track, const std::filesystem::path& file);

/// Two cones of one boundary within this distance [m] count as one.
inline constexpr double kDoubledTrackCone_m = 0.3;

/// The track without cones within kDoubledTrackCone_m of an earlier cone of the same boundary: the later one
/// is removed from the boundary and the map, and so are cones of no boundary that are known to repeat others.
[[nodiscard]] Track without_doubled_cones(Track track, const std::vector<std::size_t>& repeated = {});

}  // namespace conelane
