#pragma once

#include "conelane/lane_detector.hpp"
#include "conelane/rld_parameters.hpp"
#include "evaluation/world/scene_generation.hpp"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace conelane {
struct DetectorRecipe;
}

namespace conelane::experiments {

/// The data that a detector learns from, and the amount of work.
struct LearningOptions {
    std::vector<std::string> tracks;  ///< SPECs of load_tracks
    SceneOptions scenes;              ///< with the seed of all draws, and the number of threads
    std::size_t variants = 1;         ///< of each track, for networks
    std::size_t evaluations = 60;     ///< number of parameter sets that tuning tries, on every fourth pose
    double front_steps = 1.0;  ///< length of the training of `front`, as a share of the shipped training
    double rld_steps = 1.0;    ///< the same of the training of `rld-learned`
    /// Folder of the files that the detectors have learned without colors. Empty: they learn these first.
    std::filesystem::path without_colors;
};

/// The file of the weights of front in the folder of a fold.
inline constexpr std::string_view kFrontFoldFile = "front.json";

using DetectorFactory = std::function<std::unique_ptr<LaneDetector>()>;

/// How a detector gets weights or parameters from courses: by the recipe of the shipped ones. If the scenes
/// have colors, the detectors that use them learn those in a second stage: `front` its set for colors,
/// `rld-learned` its costs on draws that show colors too, and `rld-shape` chooses w_color.
struct Learner {
    /// Learns and writes its files to the folder. Existing files are not learned again, so detectors share
    /// them and a stopped run resumes. Throws InputError or InvalidInput.
    void (*learn)(const DetectorRecipe& recipe, const LearningOptions& options,
                  const std::filesystem::path& folder);
    /// What the files hold: parameters of RLD for the recipe, or else how to make the detector. Throws
    /// InputError if one is missing or invalid.
    std::variant<DetectorFactory, RldParameters> (*load)(const DetectorRecipe& recipe,
                                                         const std::filesystem::path& folder);
};

/// The learner of a detector; null if it learns nothing. Every tuned detector has one: random search.
[[nodiscard]] const Learner* find_learner(const DetectorRecipe& recipe);

}  // namespace conelane::experiments
