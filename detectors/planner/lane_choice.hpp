#pragma once

#include "detectors/planner/rigid_shift.hpp"

#include <array>

namespace conelane {

/// So many frames have to trust a place before it stays trusted.
inline constexpr std::size_t kTrustingFrames = 3;

/// The lane that the car drives by, and its remaining part.
class PathMemory {
  public:
    explicit PathMemory(const LaneChoiceSettings& settings, double step_m, double max_age_s)
        : settings_(settings), step_m_(step_m), max_age_s_(max_age_s) {}

    /// Sets the lane, which begins at the car.
    void remember(const DrivableLane& lane, double time_s);
    void move_along(const RigidShift& shift);

    /// The lane from the car on: no points if there is none, it is too old, or the car is off it or at its
    /// end.
    [[nodiscard]] DrivableLane left(const Pose& pose, double time_s);
    /// How far a lane of this frame is trusted: as far as its detector says, `trusted_m`, or as far as three
    /// earlier frames said, less what the car has driven since. What earlier frames said ends where this
    /// frame contradicts it, at `until_m`.
    [[nodiscard]] double steady_trust_m(double trusted_m, double until_m);
    /// Why `left` had no points the last time.
    [[nodiscard]] std::string_view why_none() const { return why_none_; }
    /// Age of the frame that the lane is from.
    [[nodiscard]] double time_s() const { return time_s_; }

  private:
    LaneChoiceSettings settings_;
    double step_m_;
    double max_age_s_;
    std::optional<DrivableLane> lane_;
    double time_s_ = 0.0;
    double reached_m_ = 0.0;  ///< arc length that the car has reached
    /// The farthest ends of the trust that frames have said, farthest first, along the lane.
    std::array<double, kTrustingFrames> trust_ends_m_{};
    std::string_view why_none_;
};

/// Decides between the lane driven so far and a new one that jumps away from it near the car.
///
/// Each frame supports the lane that it gives, in all places of it, with a weight: the probability that its
/// detector gives. The support of a new lane, from at least two frames, has to reach that of the lane driven
/// so far at the place where the new one leaves it, which is at most settings.max_support. So uncertain
/// frames change nothing, a wrong lane is left after some frames, and a far stretch that was seen a moment
/// ago does not profit from what frames said of the stretch before it.
class LaneChoice {
  public:
    explicit LaneChoice(const LaneChoiceSettings& settings) : settings_(settings) {}

    /// Whether a lane continues the one driven so far, or too little of that one is left. `left`: the rest of
    /// the lane driven so far; without points there is none.
    [[nodiscard]] bool agrees(const DrivableLane& lane, const DrivableLane& left) const;
    /// Whether to drive by `fresh` from now on, which the frame supports with `weight`. `kept_weight`: the
    /// frame's support of the lane driven so far if `fresh` disagrees with it; 0 for no support.
    [[nodiscard]] bool take(const DrivableLane& fresh, const DrivableLane& left, double weight = 1.0,
                            double kept_weight = 0.0);
    void move_along(const RigidShift& shift);

  private:
    /// A place of the lane driven so far, and the weights of the frames that support the lane there.
    struct Supported {
        Point place;
        double weight;
    };
    [[nodiscard]] bool is_spent(const DrivableLane& left) const;
    void support(const DrivableLane& lane, double weight);
    /// Support of the lane driven so far at the place where `fresh` leaves it.
    [[nodiscard]] double support_where_left(const DrivableLane& fresh, const DrivableLane& left) const;

    LaneChoiceSettings settings_;
    std::vector<Supported> driven_;
    std::optional<DrivableLane> challenger_;
    double challenger_support_ = 0.0;
    int challenger_frames_ = 0;
};

}  // namespace conelane
