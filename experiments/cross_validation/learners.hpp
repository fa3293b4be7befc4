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

/// What a detector learns from, and how much work it may take.
struct LearningOptions {
    std::vector<std::string> tracks;  ///< SPECs of load_tracks
    SceneOptions scenes;              ///< with the seed of all draws, and the number of threads
    std::size_t variants = 1;         ///< of each track, for networks
    std::size_t evaluations = 60;     ///< of parameters that are tuned, on every fourth pose
    double front_steps = 1.0;  ///< of the training of `front`, as a share of those of the shipped weights
    double rld_steps = 1.0;    ///< the same of the training of `rld-learned`
};

/// The file of the weights of front in the folder of a fold.
inline constexpr std::string_view kFrontFoldFile = "front.json";

/// A detector whose weights or parameters come from courses, by the recipe of those that are shipped.
struct Learner {
    std::string_view detector;
    /// Learns and writes its files to the folder; what is there already is not learned again, so that
    /// detectors share it and a run that was stopped goes on. Throws InputError or InvalidInput.
    void (*learn)(const LearningOptions& options, const std::filesystem::path& folder);
    /// What answers by these files. Throws InputError where one is missing or wrong.
    DetectorMaker (*maker)(const std::filesystem::path& folder, const RunOptions& options);
};

/// front, front-warm, clc, clc-warm, clc-paper, delaunay-beam, astar-lane, rld-shape and rld-learned.
[[nodiscard]] std::span<const Learner> learners();

/// None where the detector learns nothing, so answers the same in every fold.
[[nodiscard]] const Learner* find_learner(std::string_view detector);

}  // namespace conelane::experiments
