#pragma once

#include <Eigen/Core>

namespace conelane {

/// A position or a vector in the map frame [m].
using Point = Eigen::Vector2d;

}  // namespace conelane
