#pragma once

#include "detectors/drivable_lane.hpp"
#include "model/lane_detector.hpp"
#include "model/rld_parameters.hpp"
#include "model/scene.hpp"

#include <cstddef>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

/// The one call: scene in, lane out.
///
///     auto detector = conelane::make_detector("clc");
///     conelane::LaneAnswer answer = detector->detect(scene, {.time_limit_ms = 20.0});
///     if (answer.status == conelane::LaneStatus::found) {
///         conelane::DrivableLane lane = conelane::drivable(answer.lane, scene);
///     }
namespace conelane {

/// A detector of the library, as `make_detector` knows it.
struct DetectorInfo {
    std::string_view name;
    std::string_view meaning;  ///< one line
};

/// All of them, the one to drive by first.
[[nodiscard]] std::vector<DetectorInfo> detectors();

/// What may be set of a detector; what is absent is as the detector of that name has it.
struct DetectorOptions {
    std::optional<RldParameters> rld_parameters;  ///< of a detector that optimises the RLD objective
    std::optional<Pairing> pairing;               ///< instead of the parameters'
    std::optional<std::size_t> nearest;           ///< answers for so many cones, the nearest ahead
};

/// The detector of that name, with its tuned parameters and trained weights: what tables show under it.
/// Throws InvalidInput, listing the names, where there is none of that name, and where options are out of
/// range. Detectors are independent of each other; each serves one thread.
[[nodiscard]] std::unique_ptr<LaneDetector> make_detector(std::string_view name,
                                                          const DetectorOptions& options = {});

}  // namespace conelane
