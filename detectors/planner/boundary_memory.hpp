#pragma once

#include "detectors/planner/cone_memory.hpp"

namespace conelane {

/// The cones of both boundaries at the car and ahead of it, as trusted lanes had them.
///
/// In a corner, a narrow view shows the outer boundary alone: the inner one goes behind the car. A detector
/// that sees one frame may then take a part of the outer boundary for the inner one. The memory knows on
/// which side the car has that boundary, and follows it on from cone to cone.
class BoundaryMemory {
  public:
    /// Adds the cones of a lane up to an arc length of `path`, its centre line: they have their side until a
    /// later lane has them on the other one.
    void learn(const Lane& lane, const DrivableLane& path, double until_m, const ConeMemory& cones);
    /// Forgets the cones that the car has left behind.
    void pass(const Pose& pose, const ConeMemory& cones);

    /// The boundary that is in view alone: at least two of its cones ahead are known or continue it smoothly,
    /// and the view shows no known cone of the other side. Nothing if both boundaries are in view, or none.
    /// Precondition: `pass` was called for these cones.
    [[nodiscard]] std::optional<Lane> alone(const Scene& scene, const ConeMemory& cones) const;

  private:
    std::array<std::vector<ConeId>, 2> known_;  ///< left and right, in the order in which they are driven by
};

}  // namespace conelane
