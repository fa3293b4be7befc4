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

/// What a detector does with the colors of cones. Unknown colors never matter.
enum class ColorUse {
    ignored,    ///< the lane is the same for all colors
    by_weight,  ///< RldParameters::w_color says how much they count; by default it is 0
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
    std::optional<RldParameters> rld_parameters = {};  ///< rld-...: the parameters of the objective
    std::optional<Pairing> pairing = {};               ///< rld-...: replaces the pairing of the parameters
    /// All detectors: answer only for this many nearest cones ahead. At least 1.
    std::optional<std::size_t> nearest = {};
    /// front, front-warm and rld-strip: weights of your own instead of the shipped ones. The path of a file
    /// that `conelane train front` or `conelane train strip` wrote, or its content.
    std::optional<std::variant<std::filesystem::path, WeightsBytes>> weights = {};
};

/// The detector of that name. Without options it is the detector that the tables show: a learned
/// detector has its trained weights, `rld-...` has the defaults of RldParameters, or those of
/// with_shape_costs; tuned sets are in rld_parameter_sets.hpp. Throws InvalidInput: for an unknown name,
/// listing the names; for an option that is out of range or that the detector does not use, naming the
/// option; and for weights that cannot be read. Detectors are independent of each other; each serves one
/// thread.
[[nodiscard]] std::unique_ptr<LaneDetector> make_detector(std::string_view name,
                                                          const DetectorOptions& options = {});

}  // namespace conelane
