#pragma once

#include "conelane/lane.hpp"
#include "conelane/scene.hpp"
#include "detectors/planner/lap_planner_settings.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace conelane {

/// A lane that a frame speaks for, and with what probability.
struct VotedLane {
    const Lane* lane;
    double weight;
};

/// What the frames so far have said of each cone: that it stands on the left boundary, on the right one, or
/// inside the lane, where no cone of the course stands.
///
/// The lanes of a frame vote with their probabilities, and each vote replaces a share of those before: what
/// is wrong is outvoted within a second by frames that are sure, so votes never hold a lane back for good.
/// Cones are known by the ids of the memory of cones; one that is in no scene any more is forgotten.
class ConeVotes {
  public:
    explicit ConeVotes(const ConeVoteSettings& settings = {}) : settings_(settings) {}

    /// Takes in what the lanes of a frame say of the cones of its scene. Of lanes that say the same of a cone
    /// the most probable one counts. Precondition: the cones are sorted by id.
    /// Weights: 0 to 1.
    void vote(const Scene& scene, std::span<const VotedLane> lanes);
    /// How much a lane contradicts the votes before, as what it takes from the log odds of the lane: at least
    /// 0, at most settings.max_objection. Cones far from the car count less. Precondition: as of `vote`.
    [[nodiscard]] double objection(const Scene& scene, const Lane& lane) const;
    void clear() { cones_.clear(); }

  private:
    struct VotedCone {
        ConeId id;
        double left = 0.0;
        double right = 0.0;
        double inside = 0.0;
    };

    [[nodiscard]] double share(const Pose& pose, const Point& cone) const;

    ConeVoteSettings settings_;
    std::vector<VotedCone> cones_;  ///< by id
};

}  // namespace conelane
