#pragma once

#include "model/geometry.hpp"

#include <cstddef>
#include <optional>
#include <vector>

namespace conelane {

/// One boundary of a lane as a polyline, measured along its length. Positions on it are arc lengths from its
/// first vertex; on a closed boundary modulo its length.
class LaneBoundary {
  public:
    /// Vertices at one place are merged. Precondition: at least one vertex.
    LaneBoundary(const std::vector<Point>& vertices, bool closed);

    [[nodiscard]] const std::vector<Point>& vertices() const { return vertices_; }
    [[nodiscard]] bool closed() const { return closed_; }
    [[nodiscard]] std::size_t segments() const { return arc_m_.size() - 1; }
    [[nodiscard]] Segment segment(std::size_t i) const {
        return {vertices_[i], vertices_[(i + 1) % vertices_.size()]};
    }
    [[nodiscard]] double segment_start_m(std::size_t i) const { return arc_m_[i]; }
    [[nodiscard]] double segment_end_m(std::size_t i) const { return arc_m_[i + 1]; }
    [[nodiscard]] double length_m() const { return arc_m_.back(); }

    /// Distance of a point from the part of the boundary within `reach_m` of a position, measured along it.
    [[nodiscard]] double distance_m(const Point& query, double place_m, double reach_m) const;

    /// Distance along a ray to its first intersection with that part of the boundary; touching counts.
    [[nodiscard]] std::optional<double> ray_hit_m(const Point& from, const Point& unit_direction,
                                                  double place_m, double reach_m) const;

  private:
    /// Calls `visit` with the index of each segment that is partly within `reach_m` of a position.
    template <typename Visit>
    void for_segments_near(double place_m, double reach_m, const Visit& visit) const;

    std::vector<Point> vertices_;
    std::vector<double> arc_m_;  ///< at each vertex; for a closed boundary also back at the first one
    bool closed_;
};

/// The unknown boundary of a lane that is `width_m` wide: a point opposite to every half metre of the known
/// boundary, in driving order. Directions are averaged over several metres, so the inferred boundary does not
/// jump where a cone turns the known one. In narrow bends, points that run backwards or come near the known
/// boundary are left out. Precondition: the boundary is open.
[[nodiscard]] std::vector<Point> inferred_boundary(const LaneBoundary& known, bool known_is_left,
                                                   double width_m);

}  // namespace conelane
