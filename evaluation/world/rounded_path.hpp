#pragma once

#include "model/geometry.hpp"

#include <vector>

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

}  // namespace conelane
