#pragma once

#include "conelane/lane_detector.hpp"
#include "evaluation/files/lane_file.hpp"
#include "evaluation/scenes/annotated_scene.hpp"
#include "experiments/comparison/known_detectors.hpp"

#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace conelane::experiments {

struct RunOptions {
    DetectorOptions detector;
    DetectionLimits limits{.time_limit_ms = std::numeric_limits<double>::infinity()};
    /// One thread runs on one processor. With more threads, contention disturbs the latencies.
    unsigned threads = 1;
    bool show_progress = true;
};

/// A detector that answers scene after scene, each timed in the same way: from the scene in memory to the
/// lane in memory, on the wall clock.
class TimedDetector {
  public:
    virtual ~TimedDetector() = default;
    [[nodiscard]] virtual LaneRecord answer(const Scene& scene) = 0;
    /// Answers the scene untimed and forgets it, so that no latency includes the loading of code.
    virtual void warm_up(const Scene& scene) = 0;
    /// Another lap begins.
    virtual void reset() = 0;
};

/// Makes the detector for a lap of the course of this name, in any thread.
using DetectorMaker = std::function<std::unique_ptr<TimedDetector>(const std::string& track)>;

/// A detector of this program. If the independent checker rejects the answer of an RLD detector, its status
/// becomes error (see check_answer; not timed). The detector must outlive the result.
[[nodiscard]] DetectorMaker maker_of(const KnownDetector& detector, const RunOptions& options);

/// Any detector under a name, on all cones.
[[nodiscard]] DetectorMaker maker_of(const std::string& name,
                                     std::function<std::unique_ptr<LaneDetector>()> make_detector,
                                     const RunOptions& options);

/// A program from outside, timed by its round trip. It runs from lap to lap, as long as the maker exists. Of
/// the options it gets only the cone-set size, and it has limits of its own (see OutsideLimits).
[[nodiscard]] DetectorMaker maker_of_program(const std::string& name, const std::string& command,
                                             const RunOptions& options);

/// RLD by a solver from outside. It gets the cones and parameters of the options; without options, all cones
/// and the default parameters. It is timed and checked like a detector of this program: the time includes
/// writing the files and reading the solution. Each lap starts the program again; the start is not timed.
[[nodiscard]] DetectorMaker maker_of_solver(const OutsideDetector& solver, const RunOptions& options);

/// The RLD parameters that a solver from outside gets.
[[nodiscard]] RldParameters solver_parameters(const DetectorOptions& options);

/// Whether two scenes are of one lap: the same track, condition, rate and range.
[[nodiscard]] bool same_lap(const AnnotatedScene& a, const AnnotatedScene& b);

/// First scene of each lap, and the number of scenes at the end. A lap is a run of scenes of one track,
/// condition, rate and range. It is the unit of work, because a detector with state must see each lap alone
/// and from its beginning.
[[nodiscard]] std::vector<std::size_t> lap_starts(std::span<const AnnotatedScene> scenes);

/// Gets the records of each lap, in the order of the laps, from one thread at a time.
using LapSink = std::function<void(std::span<const LaneRecord>)>;

/// Runs a detector on every scene, with a new TimedDetector for each lap. The first scene of a lap is
/// answered untimed before. The cut to the cone set is part of the detector and of its time.
void run(const std::string& name, const DetectorMaker& make, std::span<const AnnotatedScene> scenes,
         const RunOptions& options, const LapSink& sink);

/// The same, all records at once.
[[nodiscard]] std::vector<LaneRecord> run(const std::string& name, const DetectorMaker& make,
                                          std::span<const AnnotatedScene> scenes, const RunOptions& options);

}  // namespace conelane::experiments
