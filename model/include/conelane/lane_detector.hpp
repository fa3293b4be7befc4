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
    none,     ///< no lane keeps the detector's rules, by proof or complete search
    stopped,  ///< no lane that can be driven was found; see LaneAnswer::stopped_by
    error,    ///< see LaneAnswer::message
};
[[nodiscard]] std::string_view to_string(LaneStatus status);

/// Optimality of an answer, from a detector that optimises a stated objective.
struct Optimality {
    double objective;
    double bound;  ///< proven lower bound, at most `objective`
    bool optimal;  ///< the gap is within the requested tolerance
};

/// A lane that a search found.
struct LaneCandidate {
    Lane lane;
    std::int64_t iteration;  ///< which found it; if candidates are sorted best first, the rank from 1
    std::optional<double> confidence = {};  ///< probability that the lane is usable
};

struct Enumeration {
    std::int64_t iterations;
    bool complete;  ///< no limit and no beam cut the search short; for clc: from the starts tried
    std::vector<LaneCandidate> candidates;  ///< as found, or best first; empty without keep_candidates
};

/// The lane that an optimising detector has solved, to check its claims. Present if it searched among more
/// cones than the answer may have and then cut the lane, or if it found the lane by another d_near.
struct SolvedLane {
    Lane lane;                                  ///< before it was cut
    std::optional<Optimality> optimality = {};  ///< of this lane
    std::optional<double> d_near_m = {};        ///< with which it is feasible; absent: that of the parameters
};

/// Cones at most this far apart [m] are one cone that a map holds twice: the smallest cone of the rules is
/// 0.228 m wide, so the middles of two cones cannot be this near. A detector may merge cones that are farther
/// apart if a scene has many of them, see LaneDetector::doubled_cone_m.
inline constexpr double kDoubledCone_m = 0.12;

/// A cone that a detector left out, because another cone is within the detector's doubled_cone_m.
struct MergedCone {
    ConeId cone;
    ConeId into;  ///< represents both cones in the lane: the one nearer to the car (ties: the smaller id)

    bool operator==(const MergedCone&) const = default;
};

/// A detector's answer. `lane` is empty unless status is found. It has cones on both sides, except from
/// `front` and `front-warm`, which may see only one boundary. Unknown values are absent.
struct LaneAnswer {
    LaneStatus status = LaneStatus::stopped;
    Lane lane;
    std::string message;
    /// The limit that ended the search. Absent if no limit did: the lane is the detector's best.
    /// `iterations` may also mean that a beam left lanes out or, with status stopped, that the lane cannot be
    /// driven.
    std::optional<StopReason> stopped_by;
    std::optional<double> confidence;  ///< probability that the lane is usable
    /// Trusted length [m], of every lane that a detector of `make_detector` finds. With a confidence it comes
    /// from probabilities. Otherwise it is the least of lane length, way to the first BridgedGap, and 10 m.
    std::optional<double> trusted_m;
    std::optional<Optimality> optimality;  ///< of `lane` itself
    std::optional<SolvedLane> solved;      ///< only after a cut to the cone set, or by another d_near
    std::optional<Enumeration> enumeration;
    std::vector<MergedCone> merged;  ///< by `cone`; empty if no cone is doubled
};

struct DetectionLimits {
    double time_limit_ms = 50.0;   ///< wall clock, from the call; infinity for none, NaN is an error
    bool keep_candidates = false;  ///< fill Enumeration::candidates
};

/// A way from a scene to a lane. Doubled cones are merged first: the detector sees the one nearest to the
/// car, and its answer, also a proof, is about the scene without the others. LaneAnswer::merged names them.
/// An instance may carry state from one scene of a lap to the next. It serves one thread; instances are
/// independent of each other.
class LaneDetector {
  public:
    LaneDetector() : LaneDetector(kDoubledCone_m) {}
    LaneDetector(const LaneDetector&) = delete;
    LaneDetector& operator=(const LaneDetector&) = delete;
    virtual ~LaneDetector();

    /// Throws only std::bad_alloc. A scene that `validate` refuses, a limit that is NaN, and any other
    /// exception of a search or its backend give status error and a message.
    [[nodiscard]] LaneAnswer detect(const Scene& scene, const DetectionLimits& limits = {});

    /// Cones at most this far apart [m] are one cone for this detector. Cones farther apart than
    /// kDoubledCone_m are merged only if these merges are at least three and a tenth of the cones kept.
    [[nodiscard]] double doubled_cone_m() const;

    /// Forgets earlier scenes.
    virtual void reset() {}

  protected:
    /// For a detector that merges cones up to `doubled_cone_m` [m] apart. Precondition: from 0 to 0.4 m.
    explicit LaneDetector(double doubled_cone_m);
    /// The answer of another detector to a scene that `detect` of this one has checked already. For detectors
    /// that call another one. Precondition: that of `search`. Throws what the other's search throws.
    [[nodiscard]] static LaneAnswer search_by(LaneDetector& detector, const Scene& scene,
                                              const DetectionLimits& limits) {
        return detector.search(scene, limits);
    }

  private:
    /// Precondition: the scene is valid and has no doubles, and the limit is not NaN.
    [[nodiscard]] virtual LaneAnswer search(const Scene& scene, const DetectionLimits& limits) = 0;

    struct Workspace;
    std::unique_ptr<Workspace> workspace_;
};

}  // namespace conelane
