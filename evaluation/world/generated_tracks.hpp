#pragma once

#include "evaluation/world/track.hpp"

namespace conelane {

/// A vertex of the polygon that guides a path, and the radius of the arc that rounds it off.
struct Corner {
    Point at;
    double radius_m;
};

/// A path of straights and tangent arcs: a polyline with rounded corners. A closed path starts where the arc
/// of its first corner ends; an open path starts and ends in its outer vertices, whose radius is ignored.
class RoundedPath {
  public:
    /// Throws InvalidInput if a radius is not positive, the path turns back on itself or the arcs of two
    /// neighbouring corners need more than the distance between them.
    RoundedPath(const std::vector<Corner>& corners, bool closed);

    [[nodiscard]] double length_m() const { return length_m_; }
    [[nodiscard]] bool closed() const { return closed_; }

    struct Place {
        Point position;
        Point direction;       ///< unit vector
        double curvature_1_m;  ///< [1/m], positive to the left
    };
    /// The place at an arc length, which wraps on a closed path and is clamped on an open one.
    [[nodiscard]] Place at(double arc_length_m) const;

  private:
    struct Piece {
        double start_m;  ///< arc length at `from`
        Point from;
        Point direction;
        double curvature_1_m;
    };
    void append(const Point& from, const Point& direction, double curvature_1_m, double piece_length_m);

    std::vector<Piece> pieces_;
    double length_m_ = 0.0;
    bool closed_;
};

/// Width of a lane and arrangement of its cones.
struct TrackStyle {
    double mean_width_m = 4.0;
    double slow_swell_m = 0.5;       ///< amplitude of the width's two or three swells a lap
    double quick_swell_m = 0.25;     ///< amplitude of its five to eight swells a lap
    double wider_in_bends_m = 0.0;   ///< added to the width in bends of 5 m, less in wider ones
    double lateral_jitter_m = 0.08;  ///< of a cone off the ideal boundary
    double widest_spacing_m = 4.05;  ///< expected on straights
    /// A bend of this radius halves the spacing. Negative: one of twice this radius doubles it.
    double spacing_per_curvature_m = 5.0;
    /// Gates: a pair of big orange cones on each side, in a gap of the boundaries.
    std::size_t gates = 0;
};

/// The drawing of a generated track: its centre line, and the number of cones of no boundary around it.
struct TrackLayout {
    std::string name;
    bool closed;
    std::vector<Corner> centre_line;
    std::size_t stray_cones;
    TrackStyle style{};
};

/// All layouts: the three topologies of the RLD paper (straight, circle, curvy), then closed circuits within
/// the limits of the Formula Student rules, of 200 to 500 m.
[[nodiscard]] std::span<const TrackLayout> track_layouts();

/// Names of the layouts that each seed draws, with properties of recorded courses that the fixed layouts do
/// not have:
/// - `legs`: four parallel legs or six, their boundaries 3 to 6 m apart;
/// - `tight_hairpins`: the same with a lane of 2.8 to 3.2 m, cones every 1.5 to 2 m, radii of about 3 m;
/// - `gates`: a loop with two gates of big orange cones, each in a gap of the boundaries of 10 to 12 m;
/// - `wide`: a loop of 4.8 to 6 m with cones up to 6 m apart;
/// - `wide_hairpins`: four parallel legs or six, the lane twice as wide in the hairpins, up to 8 m;
/// - `sparse`: a loop with cones 4 to 5.5 m apart, in bends 6 to 11 m;
/// - `sharp`: a loop of corners whose inner boundary turns at 0.3 to 1.5 m.
[[nodiscard]] std::span<const std::string_view> drawn_layout_names();

/// Precondition: the name is one of drawn_layout_names.
[[nodiscard]] TrackLayout draw_layout(std::string_view name, std::uint64_t seed);

/// The names that generate_track knows: the fixed layouts of track_layouts, then those of drawn_layout_names.
[[nodiscard]] std::vector<std::string> generated_track_names();

/// A made-up track: cones on both sides of the layout's centre line. On the fixed layouts, within the Formula
/// Student rules: the lane 3 to 5 m wide, the width swelling along the lap; cones of one side at most 5 m
/// apart, uneven, denser in tight bends and a little off the ideal boundary. On the drawn ones lanes of 2.8
/// to 8 m, cones 1.5 to 11 m apart, legs 3 to 6 m from each other, and gates. Left cones are blue, right
/// ones yellow, those of gates orange; stray ones are of unknown color and belong to no boundary.
/// Coordinates are multiples of 0.1 mm, the same on any machine. The track is named `name`, `name@seed` where
/// the seed is not 0. Throws InvalidInput if the name is unknown.
[[nodiscard]] Track generate_track(const std::string& name, std::uint64_t seed);

}  // namespace conelane
