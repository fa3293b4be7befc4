#pragma once

#include "model/scene.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace conelane {

/// Both boundaries of a lane, as cone ids in driving order from the car outward.
struct Lane {
    std::vector<ConeId> left;
    std::vector<ConeId> right;
    bool closed = false;  ///< a whole circuit: each boundary returns from its last cone to its first

    bool operator==(const Lane&) const = default;
};

/// Widest lane [m]: beyond it one side has gone on alone.
inline constexpr double kWidestLane_m = 6.5;

/// Drops far ends until the last cone of each side is within kWidestLane_m of the polyline of the other side;
/// where both ends are too far, the left one goes first. A closed lane stays as it is, and so does a lane
/// with an empty side. Precondition: every id of the lane is a cone of the scene.
void even_far_ends(Lane& lane, const Scene& scene);

/// What of a lane lies among the scene's `nearest` cones ahead: each boundary is cut at its first cone that
/// is none of them, then the far ends are evened. A boundary may be left with one cone or none, and only a
/// lane that was not cut stays closed. Precondition: every id of the lane is a cone of the scene.
[[nodiscard]] Lane cut_to_nearest(Lane lane, const Scene& scene, std::size_t nearest);

enum class LaneStatus {
    found,
    none,        ///< proven or searched to the end: the scene has no feasible lane
    time_limit,  ///< nothing found in time
    error,       ///< see LaneAnswer::message
};
[[nodiscard]] std::string_view to_string(LaneStatus status);

/// What a method that optimises a stated objective knows of its answer.
struct Optimality {
    double objective;
    double bound;  ///< proven lower bound, at most `objective`
    bool optimal;  ///< the gap is within the tolerance asked for
};

/// A lane that an enumerating method met, and when.
struct LaneCandidate {
    Lane lane;
    std::int64_t iteration;
};

struct Enumeration {
    std::int64_t iterations;
    bool complete;                          ///< the search space was exhausted before the iteration limit
    std::vector<LaneCandidate> candidates;  ///< in the order met; empty unless asked for
};

/// The lane that was found among more cones than it is answered for, before it was cut to those.
struct UncutLane {
    Lane lane;
    std::optional<Optimality> optimality;
};

/// A detector's answer. `lane` is empty unless status is found. What a method does not know stays absent.
struct LaneAnswer {
    LaneStatus status = LaneStatus::none;
    Lane lane;
    std::string message;
    std::optional<double> confidence;      ///< probability that the lane is right
    std::optional<double> trusted_m;       ///< distance up to which the lane can be trusted
    std::optional<Optimality> optimality;  ///< of `lane` itself; absent where it was cut
    std::optional<UncutLane> uncut;        ///< where `lane` was cut; no file holds it
    std::optional<Enumeration> enumeration;
};

struct DetectionLimits {
    double time_limit_ms = std::numeric_limits<double>::infinity();  ///< wall clock, from the call
    bool keep_candidates = false;                                    ///< fill Enumeration::candidates
};

/// A way from a scene to a lane. An instance may carry state from one scene of a lap to the next and serves
/// one thread; `reset` forgets that state. `detect` throws nothing but std::bad_alloc on a scene that
/// `validate` accepts.
class LaneDetector {
  public:
    virtual ~LaneDetector() = default;
    [[nodiscard]] virtual LaneAnswer detect(const Scene& scene, const DetectionLimits& limits) = 0;
    virtual void reset() {}
};

}  // namespace conelane
