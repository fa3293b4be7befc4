#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>

namespace conelane {

/// A position or a vector in the plane [m]; a direction has no unit. Members are called as Eigen calls them,
/// and conversions from and to Eigen's vectors are implicit; this header needs no other library.
class Point {
  public:
    constexpr Point() = default;  ///< 0, 0
    constexpr Point(double x, double y) : x_m_(x), y_m_(y) {}
    template <typename Vector>
    requires requires(const Vector& vector) {
        { vector.x() } -> std::convertible_to<double>;
        { vector.y() } -> std::convertible_to<double>;
    }
    // NOLINTNEXTLINE(google-explicit-constructor)
    constexpr Point(const Vector& vector) : x_m_(vector.x()), y_m_(vector.y()) {}
    template <typename Vector>
    requires(std::constructible_from<Vector, double, double>&& requires(const Vector& vector) {
        vector.x();
    }) constexpr
    operator Vector() const {  // NOLINT(google-explicit-constructor)
        return Vector(x_m_, y_m_);
    }

    [[nodiscard]] constexpr double x() const { return x_m_; }
    [[nodiscard]] constexpr double y() const { return y_m_; }
    constexpr double& x() { return x_m_; }
    constexpr double& y() { return y_m_; }

    constexpr Point& operator+=(const Point& b) { return *this = {x_m_ + b.x_m_, y_m_ + b.y_m_}; }
    constexpr Point& operator-=(const Point& b) { return *this = {x_m_ - b.x_m_, y_m_ - b.y_m_}; }
    constexpr Point& operator*=(double factor) { return *this = {x_m_ * factor, y_m_ * factor}; }
    constexpr Point& operator/=(double divisor) { return *this = {x_m_ / divisor, y_m_ / divisor}; }
    friend constexpr Point operator-(const Point& a) { return {-a.x_m_, -a.y_m_}; }
    friend constexpr Point operator+(Point a, const Point& b) { return a += b; }
    friend constexpr Point operator-(Point a, const Point& b) { return a -= b; }
    friend constexpr Point operator*(Point a, double factor) { return a *= factor; }
    friend constexpr Point operator*(double factor, Point a) { return a *= factor; }
    friend constexpr Point operator/(Point a, double divisor) { return a /= divisor; }
    friend constexpr bool operator==(const Point& a, const Point& b) = default;

    [[nodiscard]] constexpr double dot(const Point& b) const { return x_m_ * b.x_m_ + y_m_ * b.y_m_; }
    [[nodiscard]] constexpr double squaredNorm() const { return dot(*this); }
    [[nodiscard]] double norm() const { return std::sqrt(squaredNorm()); }
    /// The vector of length 1 in this direction; unchanged where the squared length is 0.
    [[nodiscard]] Point normalized() const { return squaredNorm() > 0.0 ? *this / norm() : *this; }
    [[nodiscard]] bool allFinite() const { return std::isfinite(x_m_) && std::isfinite(y_m_); }

    /// By coordinate: the magnitude, the smaller and the larger value.
    [[nodiscard]] Point cwiseAbs() const { return {std::abs(x_m_), std::abs(y_m_)}; }
    [[nodiscard]] Point cwiseMin(const Point& b) const {
        return {std::min(x_m_, b.x_m_), std::min(y_m_, b.y_m_)};
    }
    [[nodiscard]] Point cwiseMax(const Point& b) const {
        return {std::max(x_m_, b.x_m_), std::max(y_m_, b.y_m_)};
    }
    /// The larger coordinate; not a number if one of them is not.
    [[nodiscard]] double maxCoeff() const { return x_m_ >= y_m_ ? x_m_ : y_m_ > x_m_ ? y_m_ : x_m_ + y_m_; }

  private:
    double x_m_ = 0.0;
    double y_m_ = 0.0;
};

}  // namespace conelane
