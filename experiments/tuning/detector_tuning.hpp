#pragma once

#include "conelane/lane_detector.hpp"
#include "evaluation/scenes/scene_set.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace conelane::experiments {

/// A number that tuning changes.
struct TunableParameter {
    std::string_view key;
    double lowest;
    double highest;
    bool logarithmic;  ///< equal steps are equal ratios
    double start;      ///< set by hand, so independent of the courses that a tuning holds out
};

/// A detector whose parameters can be tuned without knowledge of their meaning.
struct TunableDetector {
    std::string_view name;
    std::vector<TunableParameter> parameters;
    /// A detector of these values, in the order of `parameters`.
    std::function<std::unique_ptr<LaneDetector>(std::span<const double>)> make;
};

/// All of them: delaunay-beam and astar-lane.
[[nodiscard]] const std::vector<TunableDetector>& tunable_detectors();

/// Throws InvalidInput that lists the names for an unknown name.
[[nodiscard]] const TunableDetector& find_tunable_detector(std::string_view name);

/// Figures of values on scenes. More often usable is better; if equal, higher IoU is better.
struct DetectorFigure {
    std::size_t scenes = 0;
    double usable = 0.0;  ///< share of the scenes
    double iou = 0.0;     ///< mean

    /// The objective of tuning: the share usable plus a tenth of the mean IoU, which guides the search where
    /// a share of a few hundred scenes does not change.
    [[nodiscard]] double value() const { return usable + 0.1 * iou; }
};

/// Answers every scene that counts, without a limit of time. The same for any number of threads.
[[nodiscard]] DetectorFigure evaluate(const TunableDetector& detector, std::span<const double> values,
                                      const SceneSet& set, unsigned threads);

struct DetectorTuningOptions {
    std::size_t evaluations = 100;  ///< at least one, the start
    std::uint64_t seed = 0;
    unsigned threads = 1;
};

struct TunedDetector {
    std::vector<double> values;  ///< four significant digits
    DetectorFigure figure;
    DetectorFigure figure_of_start;
};

/// Random search: the start, then points drawn uniformly from the ranges for two fifths of the evaluations,
/// then points around the best so far in steps that shrink from a quarter of each range to a fortieth. The
/// best point evaluated is the answer. The same scenes, seed and options give the same answer. `advance` is
/// called after each evaluation.
[[nodiscard]] TunedDetector tune_detector(const TunableDetector& detector, const SceneSet& set,
                                          const DetectorTuningOptions& options,
                                          const std::function<void()>& advance = {});

/// One flat JSON object, as the parameter files of detectors are.
[[nodiscard]] std::string to_json_text(const TunableDetector& detector, std::span<const double> values);

}  // namespace conelane::experiments
