#pragma once

#include "detectors/planner/known_course.hpp"
#include "model/deadline.hpp"

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
    double range_m = 0.0;      ///< distance of the farthest cone, if it is not far behind all others
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

/// Pose of a known course in the map, and its width.
struct Registration {
    Pose course;              ///< its origin and x axis, in the map frame
    double widening_m = 0.0;  ///< change of the half width

    [[nodiscard]] Point to_course(const Point& in_map) const;
    [[nodiscard]] Point to_map(const Point& in_course) const;
};

/// How well a registration explains cones.
struct RegistrationFit {
    Registration registration;
    double score = 0.0;  ///< cones on boundaries, less for cones that are off, less for places without a cone
    int matched = 0;     ///< cones on a boundary
    int beside = 0;  ///< cones beside a boundary, in a band of the same area: as many are expected by chance
    int places = 0;  ///< places in view that should have a cone on the boundary
    int taken = 0;   ///< number of these places with a cone
    double farthest_m = 0.0;  ///< distance of the farthest cone on a boundary ahead of the car
};

/// Largest deviation of the car from its expected place in a search.
struct SearchReach {
    double ahead_m = 4.5;  ///< ignored if the boundaries do not determine the place along x
    double left_m = 4.0;
    double yaw_rad = 0.5;
};

/// Standard deviations of a registration.
struct Stiffness {
    double place_m = 0.5;
    double yaw_rad = 0.05;
    double widening_m = 0.1;
};

/// Finds a known course among cones.
class KnownRegistration {
  public:
    explicit KnownRegistration(KnownCourse course);

    [[nodiscard]] const KnownCourse& course() const { return course_; }

    /// The registrations that explain the cones best, among those with the car within `reach` of `expected`
    /// (course coordinates): the best first, then distinct ones that explain them nearly as well. Nothing if
    /// none explains enough cones, or `deadline` passed. If the boundaries do not determine the place along
    /// x, that of `expected` is kept. The time is bounded by the reach, for any number of cones.
    [[nodiscard]] std::vector<RegistrationFit> contenders(std::span<const SeenCone> all,
                                                          std::span<const SeenView> views, const Pose& car,
                                                          const Pose& expected, const SearchReach& reach = {},
                                                          const Deadline& deadline = Deadline()) const;

    /// Moves a registration onto the cones near the car, by at most about a meter. Directions that the cones
    /// do not determine are kept; `stiffness` is the weight of the old registration.
    [[nodiscard]] Registration refine(Registration registration, std::span<const SeenCone> all,
                                      const Point& car, const Stiffness& stiffness = {}) const;

    /// How well a registration explains the cones. Places in `views` without a cone lower the score.
    [[nodiscard]] RegistrationFit fit(const Registration& registration, std::span<const SeenCone> all,
                                      std::span<const SeenView> views, const Pose& car) const;

  private:
    /// Distance of the next boundary to each place, for one width.
    struct Raster {
        double widening_m = 0.0;
        std::vector<float> nearness;
    };
    [[nodiscard]] Raster raster(double widening_m) const;
    /// Sum over cones, whose places are in cells of the raster, moved by as many cells.
    [[nodiscard]] float nearness(const Raster& raster, std::span<const Point> in_cells,
                                 const Point& moved_cells) const;
    [[nodiscard]] std::vector<RegistrationFit> candidates(std::span<const SeenCone> cones, const Pose& car,
                                                          const Pose& expected, const SearchReach& reach,
                                                          const Deadline& deadline) const;

    KnownCourse course_;
    Point raster_from_{0.0, 0.0};
    int columns_ = 0;
    int rows_ = 0;
    std::vector<Raster> rasters_;
};

}  // namespace conelane
