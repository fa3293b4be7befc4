#pragma once

#include "conelane/lane.hpp"
#include "conelane/scene.hpp"
#include "conelane/stop_reason.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace conelane {

enum class LaneStatus {
    found,
    none,     ///< by proof or complete search: the scene has no feasible lane
    stopped,  ///< nothing found before a limit, see LaneAnswer::stopped_by
    error,    ///< see LaneAnswer::message
};
[[nodiscard]] std::string_view to_string(LaneStatus status);

/// What a method that optimises a stated objective knows of its answer.
struct Optimality {
    double objective;
    double bound;  ///< proven lower bound, at most `objective`
    bool optimal;  ///< the gap is within the tolerance asked for
};

/// A lane that an enumerating method met, and when; or one of the best of a method that has an order of them,
/// and its place, from 1.
struct LaneCandidate {
    Lane lane;
    std::int64_t iteration;
    std::optional<double> confidence = {};  ///< probability that the lane is right
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

/// A detector's answer. `lane` is empty unless status is found. What a method does not know stays absent.
struct LaneAnswer {
    LaneStatus status = LaneStatus::stopped;
    Lane lane;
    std::string message;
    /// The limit that ended the search. Absent where it ran to its end: then a lane is the detector's best.
    std::optional<StopReason> stopped_by;
    std::optional<double> confidence;      ///< probability that the lane is right
    std::optional<double> trusted_m;       ///< distance up to which the lane can be trusted
    std::optional<Optimality> optimality;  ///< of `lane` itself; absent where it was cut
    std::optional<UncutLane> uncut;        ///< where `lane` was cut; no file holds it
    std::optional<Enumeration> enumeration;
};

struct DetectionLimits {
    double time_limit_ms = 50.0;   ///< wall clock, from the call; infinity for none, NaN is an error
    bool keep_candidates = false;  ///< fill Enumeration::candidates
};

/// A way from a scene to a lane. An instance may carry state from one scene of a lap to the next and serves
/// one thread; instances are independent of each other.
class LaneDetector {
  public:
    virtual ~LaneDetector() = default;

    /// Throws nothing but std::bad_alloc: a scene that `validate` refuses, a limit that is NaN and whatever a
    /// search or its backend throws give status error and a message.
    [[nodiscard]] LaneAnswer detect(const Scene& scene, const DetectionLimits& limits = {});

    /// Forgets what was carried from earlier scenes.
    virtual void reset() {}

  private:
    /// Precondition: the scene is valid and the limit is a number.
    [[nodiscard]] virtual LaneAnswer search(const Scene& scene, const DetectionLimits& limits) = 0;

    std::vector<ConeId> ids_;  ///< workspace of `validate`
};

}  // namespace conelane
