#pragma once

#include "model/geometry.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace conelane {

/// Uniform cubic spline r near points at equal parameters u: the one with the least
///     sum of spacing * weight * |r - point|^2 + smoothing^6 * integral of |r''' + turning^2 r'|^2,
/// derivatives by u, those of the integral from differences of the control points (a P-spline). `turning` is
/// how fast the direction of r is expected to turn; a curve that turns like this at constant speed, a circle
/// or a straight line, costs nothing and is left as it is, at the ends too. Position, direction and curvature
/// are continuous.
class SmoothingSpline {
  public:
    struct Jet {
        Point position;
        Point first;   ///< derivative by the parameter
        Point second;  ///< second derivative
    };

    /// Point i stands at parameter i * spacing_m. A closed spline returns to its first point after the last.
    /// Preconditions: an odd number of at least three points, of a closed one an even number of at least
    /// four; as many positive weights.
    SmoothingSpline(std::span<const Point> points, std::span<const double> weights, double spacing_m,
                    double smoothing_m, bool closed, std::span<const double> turning_1pm = {});

    /// Precondition: 0 <= parameter <= the parameter of the last point, or of the first one after a turn.
    [[nodiscard]] Jet at(double parameter_m) const;

    /// How fast the direction turns [rad per unit of the parameter] in the middle of each interval, which
    /// reaches over two spacings; a curvature above `sharpest_1pm` counts as that.
    [[nodiscard]] std::vector<double> turning_1pm(double sharpest_1pm) const;

  private:
    std::vector<Point> control_;
    double knot_spacing_m_;
    std::size_t intervals_;
};

}  // namespace conelane
