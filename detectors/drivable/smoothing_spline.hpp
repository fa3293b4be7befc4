#pragma once

#include "model/geometry.hpp"

#include <vector>

namespace conelane {

/// Uniform cubic spline r near points at equal parameters u: the one with the least
///     sum of spacing * weight * |r - point|^2 + smoothing^6 * integral of |r''' + turning^2 r'|^2,
/// with derivatives by u; the derivatives of the integral come from differences of the control points (a
/// P-spline). `turning` is the expected rate of turn of r. A curve that turns at this rate with constant
/// speed, a circle or a straight line, costs nothing and stays unchanged, also at its ends. Position,
/// direction and curvature are continuous.
class SmoothingSpline {
  public:
    struct Jet {
        Point position;
        Point first;   ///< derivative by the parameter
        Point second;  ///< second derivative
    };

    /// Point i has parameter i * spacing_m. A closed spline returns to its first point after the last.
    /// Preconditions: an odd number of at least three points, for a closed spline an even number of at least
    /// four; as many positive weights.
    SmoothingSpline(std::span<const Point> points, std::span<const double> weights, double spacing_m,
                    double smoothing_m, bool closed, std::span<const double> turning_1pm = {});

    /// Precondition: 0 <= parameter <= the parameter of the last point; for a closed spline, of the first
    /// point after a turn.
    [[nodiscard]] Jet at(double parameter_m) const;

    /// Rate of turn [rad per unit of the parameter] in the middle of each interval of two spacings; a
    /// curvature above `sharpest_1pm` is clipped to it.
    [[nodiscard]] std::vector<double> turning_1pm(double sharpest_1pm) const;

  private:
    std::vector<Point> control_;
    double knot_spacing_m_;
    std::size_t intervals_;
};

}  // namespace conelane
