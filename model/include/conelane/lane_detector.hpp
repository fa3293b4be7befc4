#pragma once

#include "conelane/lane.hpp"
#include "conelane/scene.hpp"
#include "conelane/stop_reason.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace conelane {

enum class LaneStatus {
    found,
    none,     ///< by proof or complete search: the scene has no feasible lane
    stopped,  ///< no lane that can be driven was found before a limit, see LaneAnswer::stopped_by
    error,    ///< see LaneAnswer::message
};
[[nodiscard]] std::string_view to_string(LaneStatus status);

/// What a detector that optimises a stated objective knows of its answer.
struct Optimality {
    double objective;
    double bound;  ///< proven lower bound, at most `objective`
    bool optimal;  ///< the gap is within the tolerance asked for
};

/// A lane that an enumerating detector met, and when; or one of the best of a detector that has an order of
/// them, and its place, from 1.
struct LaneCandidate {
    Lane lane;
    std::int64_t iteration;
    std::optional<double> confidence = {};  ///< probability that the lane is usable
};

struct Enumeration {
    std::int64_t iterations;
    bool complete;                          ///< the search space was exhausted before the iteration limit
    std::vector<LaneCandidate> candidates;  ///< in the order met, or the best first; empty unless asked for
};

/// The lane that was found among more cones than it is answered for, before it was cut to those.
struct UncutLane {
    Lane lane;
    std::optional<Optimality> optimality;
};

/// Cones of a scene that stand at most this far apart [m] are one cone that a map holds twice: the base of
/// the smallest cone of the rules is 0.228 m wide, so the middles of two cones cannot be that near.
inline constexpr double kDoubledCone_m = 0.12;

/// A cone that a detector did not look at, since it stands within kDoubledCone_m of another one.
struct MergedCone {
    ConeId cone;
    ConeId into;  ///< the smaller id, which stands for both in the lane

    bool operator==(const MergedCone&) const = default;
};

/// A detector's answer. `lane` is empty unless status is found. It has cones on both sides, but for detectors
/// that say otherwise of scenes which show one boundary alone (front). What a detector does not know stays
/// absent.
struct LaneAnswer {
    LaneStatus status = LaneStatus::stopped;
    Lane lane;
    std::string message;
    /// The limit that ended the search. Absent where it ran to its end: then a lane is the detector's best.
    std::optional<StopReason> stopped_by;
    std::optional<double> confidence;  ///< probability that the lane is usable
    /// Distance up to which the lane can be trusted. Of a detector that `make_detector` makes every lane has
    /// one. With a confidence it follows from probabilities; without one it is a rule and no probability: as
    /// far as both boundaries were seen without a gap, and 10 m at most.
    std::optional<double> trusted_m;
    std::optional<Optimality> optimality;  ///< of `lane` itself; absent where it was cut
    std::optional<UncutLane> uncut;        ///< where `lane` was cut; no file holds it
    std::optional<Enumeration> enumeration;
    std::vector<MergedCone> merged;  ///< by `cone`; empty where no cone is doubled; no file holds it
};

struct DetectionLimits {
    double time_limit_ms = 50.0;   ///< wall clock, from the call; infinity for none, NaN is an error
    bool keep_candidates = false;  ///< fill Enumeration::candidates
};

/// A way from a scene to a lane. It looks at each cone once: of cones that are doubled it sees the one with
/// the smallest id, and what it says, proofs as well, is said of the scene without the others, which
/// LaneAnswer::merged names. An instance may carry state from one scene of a lap to the next and serves
/// one thread; instances are independent of each other.
class LaneDetector {
  public:
    LaneDetector();
    LaneDetector(const LaneDetector&) = delete;
    LaneDetector& operator=(const LaneDetector&) = delete;
    virtual ~LaneDetector();

    /// Throws nothing but std::bad_alloc: a scene that `validate` refuses, a limit that is NaN and whatever a
    /// search or its backend throws give status error and a message.
    [[nodiscard]] LaneAnswer detect(const Scene& scene, const DetectionLimits& limits = {});

    /// Forgets what was carried from earlier scenes.
    virtual void reset() {}

  protected:
    /// What another detector finds in a scene that has passed `detect` already, so that nothing is checked
    /// again: for detectors that stand before another. Precondition: that of `search`. Throws what its search
    /// throws.
    [[nodiscard]] static LaneAnswer search_by(LaneDetector& detector, const Scene& scene,
                                              const DetectionLimits& limits) {
        return detector.search(scene, limits);
    }

  private:
    /// Precondition: the scene is valid and has no doubles, and the limit is a number.
    [[nodiscard]] virtual LaneAnswer search(const Scene& scene, const DetectionLimits& limits) = 0;

    struct Workspace;
    std::unique_ptr<Workspace> workspace_;
};

}  // namespace conelane
