#pragma once

#include "conelane/scene.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace conelane::experiments {

class Study;

/// How often a lane is claimed where there is none.
[[nodiscard]] std::unique_ptr<Study> make_noise_study();

struct NoiseOptions {
    std::vector<std::string> detectors{"front", "front-warm"};
    std::size_t cones = 16;                          ///< in each scene, all of them false
    std::vector<double> ranges_m{20.0, 30.0, 50.0};  ///< radius of the half disc that holds them
    std::size_t scenes = 1000;                       ///< for each range
    double confidence = 0.3;                         ///< a lane of a higher one is claimed
    double time_limit_ms = 1000.0;
    std::uint64_t seed = 1;
};

/// One detector over all scenes of a range.
struct NoiseRow {
    std::string detector;
    double range_m = 0.0;
    std::size_t scenes = 0;
    std::size_t found = 0;         ///< answers with a lane
    std::size_t unrated = 0;       ///< of these, lanes without a confidence
    std::size_t claimed = 0;       ///< lanes of a confidence above NoiseOptions::confidence
    double max_confidence = 0.0;   ///< of all lanes; 0 where none has one
    double mean_trusted_m = 0.0;   ///< over all scenes; 0 counts where there is no lane
    std::size_t trusted_10_m = 0;  ///< lanes that are trusted for 10 m or more
};

/// The number `index` of the scenes of a range: cones that are uniform in the closed half disc ahead of the
/// car at the origin. Depends on seed, range, number of cones and `index` alone.
[[nodiscard]] Scene noise_scene(const NoiseOptions& options, double range_m, std::size_t index);

/// Detectors in their order, each with the ranges in theirs. Every scene is one of its own: detectors that
/// remember their last lane forget it. Throws InvalidInput where a detector is unknown or a range is not
/// above 0, and std::runtime_error where an answer has status error.
[[nodiscard]] std::vector<NoiseRow> noise_rows(const NoiseOptions& options);

}  // namespace conelane::experiments
