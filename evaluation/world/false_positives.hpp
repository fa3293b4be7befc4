#pragma once

#include "evaluation/world/course.hpp"
#include "evaluation/world/scene_draws.hpp"

#include <cstdint>
#include <span>
#include <unordered_set>
#include <vector>

#include <boost/random/mersenne_twister.hpp>

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

/// The wanted number of persistent points in view from one place.
struct PersistentView {
    HalfDisc view;
    double expected_points = 0.0;
};

/// Points drawn once in the world that `views` cover. Their density at a place is the mean of the densities
/// that the views containing it want, so each view is expected to hold about its number, exactly so if all
/// want the same. All views have one radius, that of the first.
[[nodiscard]] std::vector<Point> draw_persistent_points(std::span<const PersistentView> views,
                                                        boost::random::mt19937_64& random);

}  // namespace conelane
