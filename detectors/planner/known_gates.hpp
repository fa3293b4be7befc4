#pragma once

#include "detectors/planner/known_registration.hpp"

namespace conelane {

/// Finds the lines of an acceleration along its lane, which the boundaries do not determine.
///
/// A gate is two cones behind each other on each side, orange ones if colors are known. Each frame adds
/// evidence for gates at places along the lane; knowledge of the start counts too. Places are x coordinates
/// of the registration, which must not change along x.
class GateEvidence {
  public:
    /// `finish_m`: distance from start line to finish.
    explicit GateEvidence(double finish_m);

    /// Counts the cones of one frame.
    void observe(const Registration& registration, const Frame& frame, const SeenView& seen);

    /// x coordinate of the start line: the likeliest place. Ties: the smaller one.
    [[nodiscard]] double start_line_m() const { return start_line_m_; }
    /// Whether a gate was seen at the finish that belongs to start_line_m().
    [[nodiscard]] bool has_seen_finish() const { return has_seen_finish_; }

  private:
    /// Evidence at one place along the lane.
    struct Place {
        double x_m = 0.0;
        double cones = 0.0;   ///< cones of a gate here, weighted sum over the frames
        double weight = 0.0;  ///< weight of these frames; 0: never in view
        double off_m = 0.0;   ///< mean offset of these cones from x_m, weighted likewise

        [[nodiscard]] bool is_known() const;
        [[nodiscard]] double mean_cones() const { return cones / weight; }
    };
    void decide();

    double finish_m_;
    /// How far frames have looked so far: a frame without a cone behind a gate does not show it.
    double range_m_ = 0.0;
    double bearing_rad_ = 0.0;
    std::vector<Place> start_;
    std::vector<Place> finish_;
    double start_line_m_ = 0.0;
    bool has_seen_finish_ = false;
};

}  // namespace conelane
