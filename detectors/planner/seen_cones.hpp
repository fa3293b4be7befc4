#pragma once

#include "conelane/planner.hpp"

#include <span>
#include <vector>

namespace conelane {

/// A cone seen in one or more frames.
struct SeenCone {
    Point position{0.0, 0.0};              ///< mean, map frame
    ConeColor color = ConeColor::unknown;  ///< the last known color seen
    int sightings = 0;
    double last_s = 0.0;  ///< time of the last frame with it
};

/// The region that a frame looked at, estimated from its cones.
struct SeenView {
    Pose pose;
    double range_m = 0.0;      ///< distance of the farthest cone
    double bearing_rad = 0.0;  ///< bearing of the cone farthest from the heading

    /// Whether a cone at this place would certainly be in view.
    [[nodiscard]] bool covers(const Point& place) const;
};

/// The view of a frame.
[[nodiscard]] SeenView view_of(const Frame& frame);

/// Cones of the last frames, identified by their places: ids may change.
class SeenCones {
  public:
    void observe(const Frame& frame);
    [[nodiscard]] std::span<const SeenCone> cones() const { return cones_; }

  private:
    std::vector<SeenCone> cones_;
};

}  // namespace conelane
