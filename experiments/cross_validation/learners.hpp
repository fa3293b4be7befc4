#pragma once

#include "evaluation/scenes/scene_generation.hpp"
#include "experiments/comparison/runner.hpp"

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

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

/// A detector whose weights or parameters come from courses, learned by the recipe of the shipped ones. If
/// the scenes have colors, the detectors that use them learn those in a second stage: `front` its set for
/// colors, `rld-learned` its costs on draws that show colors too, and `rld-shape` chooses w_color.
struct Learner {
    std::string_view detector;
    /// Learns and writes its files to the folder. Existing files are not learned again, so detectors share
    /// them and a stopped run resumes. Throws InputError or InvalidInput.
    void (*learn)(const LearningOptions& options, const std::filesystem::path& folder);
    /// The detector with these files. Throws InputError if one is missing or invalid.
    DetectorMaker (*maker)(const std::filesystem::path& folder, const RunOptions& options);
};

/// front, front-warm, clc, clc-warm, clc-paper, delaunay-beam, astar-lane, rld-shape and rld-learned.
[[nodiscard]] std::span<const Learner> learners();

/// Null if the detector learns nothing, so its answers are the same in every fold.
[[nodiscard]] const Learner* find_learner(std::string_view detector);

}  // namespace conelane::experiments
