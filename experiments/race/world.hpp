#pragma once

#include "evaluation/world/scene_generation.hpp"
#include "experiments/race/course.hpp"

#include <array>

#include <boost/random/mersenne_twister.hpp>

namespace conelane::experiments {

/// Where the map of the car lies in the world.
struct MapFrame {
    double yaw_rad = 0.0;
    Point shift{0.0, 0.0};  ///< [m]: map = rotated world + shift

    [[nodiscard]] Point to_map(const Point& world) const;
    [[nodiscard]] Point to_world(const Point& map) const;
    [[nodiscard]] Pose to_map(const Pose& world) const;
    /// Rotated about a point of the world, then moved.
    [[nodiscard]] MapFrame turned(double angle_rad, const Point& about, const Point& moved) const;
};

struct SightOptions {
    Condition condition;
    double false_positive_rate = 0.0;  ///< false positives / all points in view, in [0, 0.99]
    double range_m = 20.0;
    double fov_rad = std::numbers::pi;  ///< angle of view, up to pi: the half disc
    double noise_by_range = 0.0;        ///< standard deviation added to the noise, for each metre of distance
    double pose_time_s = 0.0;  ///< correlation time of the pose error; 0: each call draws another one
    bool with_color = false;   ///< else every cone is of unknown color
    bool with_ids = true;      ///< else every cone has kNoId
    std::uint64_t seed = 0;
};

/// The cones and false positives around a course, and what a car sees of them.
class World {
  public:
    World(const RaceCourse& course, const SightOptions& options);

    /// The pose that the car believes, in the frame of the world. Its error is a process of first order
    /// (Gauss and Markov) with `pose_time_s`. `step_s`: since the last call.
    [[nodiscard]] Pose disturbed(const Pose& truth, double step_s);

    /// The cones that are seen, in the map frame. `believed` is in the frame of the world. Each call draws
    /// which cones and persistent false positives are missed, and their noise.
    [[nodiscard]] Frame look(const Pose& believed, const MapFrame& map, double time_s);

    /// Gives every point in the world another id.
    void change_ids();

    /// Persistent false positives; empty if the condition draws new ones in each frame.
    [[nodiscard]] const std::vector<Point>& false_positives() const { return false_positives_; }

  private:
    using Generator = boost::random::mt19937_64;

    void add_persistent(const RaceCourse& course);
    void add_fresh(std::vector<Cone>& cones, const Pose& believed, const MapFrame& map);
    [[nodiscard]] Cone false_positive(const Point& position);
    [[nodiscard]] double false_to(double seen) const;
    [[nodiscard]] bool sees(const Pose& believed, const Point& place) const;

    const SightOptions options_;
    std::vector<Cone> points_;  ///< of the world: cones and persistent false positives
    std::vector<Point> false_positives_;
    Generator random_;
    std::optional<std::array<double, 2>> pose_error_;  ///< to the left and in yaw, in standard deviations
    ConeId id_space_ = 0;
    std::vector<ConeId> used_ids_;
    [[nodiscard]] ConeId new_id();
};

struct SteeringLimits {
    double wheelbase_m = 1.55;
    double max_steering_rad = 0.55;  ///< turns on a radius of 2.5 m
    double max_steering_rate_radps = 2.0;
};

/// A kinematic bicycle; the pose is that of its rear axle.
struct Vehicle {
    Pose pose;
    double steering_rad = 0.0;

    /// Moves on at a constant speed; the steering follows `wanted_rad` within its limits.
    void drive(double speed_mps, double wanted_rad, double time_s, const SteeringLimits& limits = {});
};

/// The steering angle of pure pursuit along `path`, followed from its beginning on by arc length: the far
/// end of a U-turn may be nearer to the car. `from_m` is the arc length reached and is moved on. 0 if
/// the path has fewer than two points.
[[nodiscard]] double pursue(const Pose& car, std::span<const Point> path, double lookahead_m, double& from_m,
                            const SteeringLimits& limits = {});

/// A path as a lane, with curvatures.
[[nodiscard]] DrivableLane lane_along(const std::vector<Point>& path);

/// The beginning of a path, of about this length.
[[nodiscard]] std::vector<Point> beginning(const std::vector<Point>& path, double length_m);

}  // namespace conelane::experiments
