#pragma once

#include "detectors/planner/known_registration.hpp"
#include "detectors/planner/seen_cones.hpp"

#include <cstddef>
#include <vector>

namespace conelane {

/// Where the lines of an acceleration are along its lane: its boundaries do not tell.
///
/// A gate is two cones behind each other at either side, orange ones where colors are known. Each frame says
/// of places along the lane how much of a gate stands there; what is known of the start counts too. Places
/// are x coordinates of the registration, which must not change along x.
class GateEvidence {
  public:
    /// `finish_m`: from start line to finish.
    explicit GateEvidence(double finish_m);

    /// Counts the cones of one frame.
    void observe(const Registration& registration, const Frame& frame, const SeenView& seen);

    /// Where the start line is, as an x coordinate; the likeliest place. Ties: the smaller one.
    [[nodiscard]] double start_line_m() const { return start_line_m_; }
    /// A gate has been seen at the finish, where start_line_m() says that it is.
    [[nodiscard]] bool has_seen_finish() const { return has_seen_finish_; }

    void clear();

  private:
    /// What was seen at one place along the lane.
    struct Place {
        double x_m = 0.0;
        double cones = 0.0;   ///< of a gate here, weighted sum over the frames
        double weight = 0.0;  ///< of these frames; 0: never in view
        double off_m = 0.0;   ///< of their mean from x_m, likewise

        [[nodiscard]] bool is_known() const;
        [[nodiscard]] double mean_cones() const { return cones / weight; }
    };
    void decide();

    double finish_m_;
    /// How far frames looked so far: where no cone stands behind a gate, its own frame does not tell.
    double range_m_ = 0.0;
    double bearing_rad_ = 0.0;
    std::vector<Place> start_;
    std::vector<Place> finish_;
    double start_line_m_ = 0.0;
    bool has_seen_finish_ = false;
};

}  // namespace conelane
