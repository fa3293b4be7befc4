#pragma once

#include "model/geometry.hpp"

#include <vector>

namespace conelane {

/// A short closed tour through all points, as a permutation of their indices: the best of several
/// nearest-neighbour tours improved by 2-opt and Or-opt moves until none shortens it, so its segments do not
/// cross. Deterministic; for a few hundred points.
[[nodiscard]] std::vector<std::size_t> shortest_tour(std::span<const Point> points);

/// The same for an open path, from either of its ends.
[[nodiscard]] std::vector<std::size_t> shortest_path(std::span<const Point> points);

}  // namespace conelane
