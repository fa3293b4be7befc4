#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

/// The planner for a node of ROS 1: conelane takes C++20, with which the messages of ROS 1 do not compile.
namespace conelane_ros1 {

/// How a frame of reference lies in the map, seen from above: translation [m] and rotation.
struct Planar {
    double x, y, xx, xy, yx, yy;
};

struct SeenCone {
    double x_m, y_m;
    int color;                   ///< 0 blue, 1 yellow, 2 orange, 3 big orange, 4 unknown
    double xx_m2, xy_m2, yy_m2;  ///< of the position; unknown if all are 0
};

struct PathPoint {
    double x_m, y_m, heading_rad, width_left_m, width_right_m;
    bool trusted;
};

struct Answer {
    std::string state;
    std::vector<PathPoint> path;
    std::vector<std::pair<std::string, std::string>> values;  ///< for the diagnostics
};

class PlannerFace {
  public:
    /// `laps` 0: the mission's own number. Throws std::exception naming an invalid option.
    PlannerFace(const std::string& mission, const std::string& detector, int laps);
    ~PlannerFace();
    /// The plan of cones in the frame `seen_from`. Throws std::exception for an invalid frame.
    Answer update(double time_s, const Planar& car, const std::vector<SeenCone>& cones,
                  const Planar& seen_from, double time_limit_ms);

  private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

}  // namespace conelane_ros1
