#include "detectors/drivable/smoothing_spline.hpp"

#include <array>

namespace conelane {
namespace {

constexpr std::size_t kBand = 4;  ///< the diagonal and three beside it
/// On a closed spline, influence decreases like exp(-distance / (2 smoothing)); this many smoothing lengths
/// leave 1e-9 of it.
constexpr double kOverlap = 40.0;

/// Symmetric positive definite band matrix with its right side.
class BandSystem {
  public:
    explicit BandSystem(std::size_t size) : rows_(size), right_(size) {}

    /// Adds weight * (v v^T, v value) for the row vector v that starts at `first`.
    template <std::size_t count>
    void add(std::size_t first, const std::array<double, count>& v, double weight, const Point& value) {
        for (std::size_t i = 0; i < count; ++i) {
            for (std::size_t j = i; j < count; ++j) rows_[first + i][j - i] += weight * v[i] * v[j];
            right_[first + i] += weight * v[i] * value;
        }
    }

    /// Solves it by LDL^T without pivoting, in place.
    std::vector<Point> solve() && {
        const std::size_t n = rows_.size();
        for (std::size_t i = 0; i < n; ++i) {
            const std::size_t beside = std::min(kBand, n - i);
            for (std::size_t k = 1; k < beside; ++k) {
                const double factor = rows_[i][k] / rows_[i][0];
                for (std::size_t j = k; j < beside; ++j) rows_[i + k][j - k] -= factor * rows_[i][j];
                right_[i + k] -= factor * right_[i];
            }
        }
        for (std::size_t i = n; i-- > 0;) {
            const std::size_t beside = std::min(kBand, n - i);
            for (std::size_t k = 1; k < beside; ++k) right_[i] -= rows_[i][k] * right_[i + k];
            right_[i] /= rows_[i][0];
        }
        return std::move(right_);
    }

  private:
    std::vector<std::array<double, kBand>> rows_;  ///< [i][d] is the entry (i, i + d)
    std::vector<Point> right_;
};

}  // namespace

SmoothingSpline::SmoothingSpline(std::span<const Point> points, std::span<const double> weights,
                                 double spacing_m, double smoothing_m, bool closed,
                                 std::span<const double> turning_1pm)
    : knot_spacing_m_(2.0 * spacing_m), intervals_(points.size() / 2) {
    // A closed spline is fitted to repeated points on both sides, far enough that the ends do not matter.
    const std::size_t overlap =
        closed ? static_cast<std::size_t>(std::ceil(kOverlap * smoothing_m / knot_spacing_m_)) : 0;
    const std::size_t data = points.size() + 4 * overlap;
    const std::size_t controls = intervals_ + 2 * overlap + 3;
    BandSystem system(controls);
    // Basis functions at a knot, where the fourth one is 0, and half-way between two knots.
    constexpr std::array<double, 3> kAtKnot{1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0};
    constexpr std::array<double, 4> kBetween{1.0 / 48.0, 23.0 / 48.0, 23.0 / 48.0, 1.0 / 48.0};
    const std::size_t shift = closed ? points.size() - 2 * overlap % points.size() : 0;
    for (std::size_t j = 0; j < data; ++j) {
        const std::size_t i = closed ? (j + shift) % points.size() : j;
        if (j % 2 == 0) {
            system.add(j / 2, kAtKnot, spacing_m * weights[i], points[i]);
        } else {
            system.add(j / 2, kBetween, spacing_m * weights[i], points[i]);
        }
    }
    // The third difference, and the first difference times the square of a turn, cancel exactly for points of
    // a circle.
    const double penalty = std::pow(smoothing_m / knot_spacing_m_, 6.0) * knot_spacing_m_;
    for (std::size_t r = 0; r + 3 < controls; ++r) {
        double square = 0.0;
        if (!turning_1pm.empty()) {
            const double rate = turning_1pm[closed ? (r + shift / 2) % intervals_ : r];
            square = std::pow(2.0 * std::sin(0.5 * rate * knot_spacing_m_), 2.0);
        }
        const std::array<double, 4> row{-1.0, 3.0 - square, square - 3.0, 1.0};
        system.add(r, row, penalty, Point());
    }
    control_ = std::move(system).solve();
    if (closed) {
        const auto first = control_.begin() + static_cast<std::ptrdiff_t>(overlap);
        std::vector<Point> around(first, first + static_cast<std::ptrdiff_t>(intervals_));
        for (std::size_t k = 0; k < 3; ++k) around.push_back(around[k]);
        control_ = std::move(around);
    }
}

SmoothingSpline::Jet SmoothingSpline::at(double parameter_m) const {
    const double knots = parameter_m / knot_spacing_m_;
    const std::size_t i = std::min(static_cast<std::size_t>(std::max(0.0, knots)), intervals_ - 1);
    const double t = knots - static_cast<double>(i);
    const double rest = 1.0 - t;
    const Point* const c = control_.data() + i;
    const Point from = c[1] - c[0];
    const Point middle = c[2] - c[1];
    const Point to = c[3] - c[2];
    return {(rest * rest * rest * c[0] + (3.0 * t * t * t - 6.0 * t * t + 4.0) * c[1] +
             (3.0 * rest * rest * rest - 6.0 * rest * rest + 4.0) * c[2] + t * t * t * c[3]) /
                6.0,
            (rest * rest * from + (1.0 + 2.0 * t * rest) * middle + t * t * to) / (2.0 * knot_spacing_m_),
            (rest * (middle - from) + t * (to - middle)) / (knot_spacing_m_ * knot_spacing_m_)};
}

std::vector<double> SmoothingSpline::turning_1pm(double sharpest_1pm) const {
    std::vector<double> rates(intervals_);
    for (std::size_t i = 0; i < intervals_; ++i) {
        const Jet jet = at((static_cast<double>(i) + 0.5) * knot_spacing_m_);
        const double speed = jet.first.norm();
        const double turned = cross(jet.first, jet.second);
        const bool sharp = std::abs(turned) > sharpest_1pm * speed * speed * speed;
        rates[i] = sharp ? std::copysign(sharpest_1pm * speed, turned) : turned / (speed * speed);
    }
    return rates;
}

}  // namespace conelane
