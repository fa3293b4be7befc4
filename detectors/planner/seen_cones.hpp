#pragma once

#include "conelane/planner.hpp"

#include <span>
#include <vector>

namespace conelane {

/// A cone as it was seen in one frame or more.
struct SeenCone {
    Point position{0.0, 0.0};              ///< mean, map frame
    ConeColor color = ConeColor::unknown;  ///< the last one seen that is known
    int sightings = 0;
    double last_s = 0.0;  ///< time of the last frame that had it
};

/// Where a frame looked, as far as its cones tell.
struct SeenView {
    Pose pose;
    double range_m = 0.0;      ///< of the farthest cone
    double bearing_rad = 0.0;  ///< of the cone farthest from the heading

    /// Whether a cone there would be in view beyond doubt.
    [[nodiscard]] bool covers(const Point& place) const;
};

/// The view of a frame.
[[nodiscard]] SeenView view_of(const Frame& frame);

/// Cones of the last frames, told apart by their places: ids may change.
class SeenCones {
  public:
    void observe(const Frame& frame);
    [[nodiscard]] std::span<const SeenCone> cones() const { return cones_; }
    void clear() { cones_.clear(); }

  private:
    std::vector<SeenCone> cones_;
};

}  // namespace conelane
