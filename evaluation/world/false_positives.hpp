#pragma once

#include "evaluation/world/course.hpp"

#include <cstddef>
#include <cstdint>
#include <unordered_set>
#include <vector>

namespace conelane {

/// Draws ids and, with colors, colors of false positives of a course.
class FalsePositives {
  public:
    FalsePositives(const Course& course, bool with_color);

    [[nodiscard]] Cone draw(const Point& position, SceneGenerator& random);

  private:
    std::int64_t space_;
    bool with_color_;
    std::unordered_set<ConeId> used_;
};

/// Number of false positives for this many seen points: k / (seen + k) = rate.
[[nodiscard]] long false_positives_to(double seen, double rate);

/// The false positives that persist along a lap of the course; none if the condition has none.
[[nodiscard]] std::vector<Cone> persistent_false_positives(const Course& course, const SceneOptions& options,
                                                           const Condition& condition, double rate,
                                                           double range_m);

}  // namespace conelane
