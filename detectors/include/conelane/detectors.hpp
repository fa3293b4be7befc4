#pragma once

#include "conelane/drivable_lane.hpp"
#include "conelane/lane_detector.hpp"
#include "conelane/rld_parameters.hpp"
#include "conelane/scene.hpp"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// The one call: scene in, lane out.
///
///     auto detector = conelane::make_detector("clc");
///     conelane::LaneAnswer answer = detector->detect(scene, {.time_limit_ms = 20.0});
///     if (answer.status == conelane::LaneStatus::found) {
///         conelane::DrivableLane lane = conelane::drivable(answer, scene);
///     }
namespace conelane {

/// Whether a detector may answer with a closed lane (Lane::closed), a whole lap in view.
enum class ClosedLanes { never, possible };

/// What a detector does with the colors of cones. Every detector takes cones of unknown color.
enum class ColorUse {
    ignored,    ///< the lane is the same for all colors
    by_weight,  ///< by RldParameters::w_color and learned costs; by default they do not count
    used,
};

/// A detector of the library, as `make_detector` knows it.
struct DetectorInfo {
    std::string_view name;
    std::string_view description;  ///< one line
    ClosedLanes closed_lanes;
    ColorUse color_use;
};

/// All detectors; the first one is meant for driving.
[[nodiscard]] std::vector<DetectorInfo> detectors();

/// The content of a file of weights, for programs that hold it in memory.
struct WeightsBytes {
    std::string bytes;
};

/// Options of a detector. An absent option keeps the detector's default. An option that the detector does
/// not use is an error.
struct DetectorOptions {
    std::optional<RldParameters> rld_parameters = {};  ///< of the objective; rld-... except rld-strip
    std::optional<Pairing> pairing = {};  ///< the same detectors: replaces the parameters' pairing
    /// All detectors: the lane has only cones among this many nearest ones ahead. At least 1.
    std::optional<std::size_t> nearest = {};
    /// front, front-warm and rld-strip: weights of your own instead of the shipped ones. The path of a file
    /// that `conelane train front` or `conelane train strip` wrote, or its content.
    std::optional<std::variant<std::filesystem::path, WeightsBytes>> weights = {};
};

/// The detector of that name. Without options a learned detector has its shipped weights, rld-learned the
/// set `learned`, rld-pair and rld-context the defaults of RldParameters. rld-shape applies with_shape_costs
/// to its parameters. Throws InvalidInput: for an unknown name, listing the names; for an option or a
/// parameter that is out of range or that the detector does not use, naming it; and for weights that cannot
/// be read. Detectors are independent of each other; each serves one thread.
[[nodiscard]] std::unique_ptr<LaneDetector> make_detector(std::string_view name,
                                                          const DetectorOptions& options = {});

/// The library's version, MAJOR.MINOR.PATCH; docs/promises.md says which interfaces stay.
[[nodiscard]] std::string_view version();

}  // namespace conelane
