#pragma once

#include "conelane/scene.hpp"

#include <array>
#include <optional>

namespace conelane {

/// The covariance that a matrix [xx, xy, yx, yy] holds. Nothing where xy and yx differ by more than 1e-6 of
/// the larger one; else xy is their mean.
[[nodiscard]] std::optional<PositionCovariance> covariance_of(const std::array<double, 4>& matrix);

}  // namespace conelane
