#pragma once

#include "detectors/planner/known_course.hpp"
#include "detectors/planner/seen_cones.hpp"
#include "model/deadline.hpp"

#include <optional>
#include <span>
#include <vector>

namespace conelane {

/// Where a known course lies in the map, and how wide it is.
struct Registration {
    Pose course;              ///< its origin and x axis, in the map frame
    double widening_m = 0.0;  ///< of the half width

    [[nodiscard]] Point to_course(const Point& in_map) const;
    [[nodiscard]] Point to_map(const Point& in_course) const;
};

/// How well a registration explains cones.
struct RegistrationFit {
    Registration registration;
    double score = 0.0;       ///< cones on boundaries, less for those that stand off, less for places without
    int matched = 0;          ///< cones on a boundary
    int beside = 0;           ///< cones beside one, in a band of the same area: as many by chance
    int places = 0;           ///< that should have a cone on the boundary, in view
    int taken = 0;            ///< of these, with one
    double farthest_m = 0.0;  ///< of the cones on a boundary from the car, ahead of it
};

/// How far the car may stand from where a search expects it.
struct SearchReach {
    double ahead_m = 4.5;  ///< ignored where the boundaries do not tell the place along x
    double left_m = 4.0;
    double yaw_rad = 0.5;
};

/// Standard deviations of how far a registration may be off.
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

    /// The registrations that explain the cones best, of those that have the car within `reach` of `expected`
    /// (course coordinates): the best first, then distinct ones that explain them nearly as well. Nothing
    /// where none explains enough cones, or `deadline` passed. Where the boundaries do not tell the place
    /// along x, that of `expected` stays. The time is bounded by the reach, whatever the number of cones.
    [[nodiscard]] std::vector<RegistrationFit> contenders(std::span<const SeenCone> cones,
                                                          std::span<const SeenView> views, const Pose& car,
                                                          const Pose& expected, const SearchReach& reach = {},
                                                          const Deadline& deadline = Deadline()) const;

    /// The only one of these, where there is only one.
    [[nodiscard]] std::optional<RegistrationFit> search(std::span<const SeenCone> cones,
                                                        std::span<const SeenView> views, const Pose& car,
                                                        const Pose& expected, const SearchReach& reach = {},
                                                        const Deadline& deadline = Deadline()) const;

    /// Moves a registration onto the cones near the car, by at most about a meter. What the cones do not
    /// determine stays; `stiffness` says against what they have to speak.
    [[nodiscard]] Registration refine(Registration registration, std::span<const SeenCone> cones,
                                      const Point& car, const Stiffness& stiffness = {}) const;

    /// What a registration explains. `views`: what they cover and no cone stands for lowers the score.
    [[nodiscard]] RegistrationFit fit(const Registration& registration, std::span<const SeenCone> cones,
                                      std::span<const SeenView> views, const Pose& car) const;

  private:
    /// How near the next boundary is to each place, for one width.
    struct Raster {
        double widening_m = 0.0;
        std::vector<float> nearness;
    };
    [[nodiscard]] Raster raster(double widening_m) const;
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
