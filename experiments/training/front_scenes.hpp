#pragma once

#include "evaluation/world/annotated_scene.hpp"
#include "evaluation/world/track.hpp"
#include "evaluation/world/track_boundaries.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace conelane::experiments {

/// Which of the changes to a course are made; for ablations.
struct FrontSceneOptions {
    std::size_t scenes_per_draw = 4;  ///< from one changed course
    bool warp = true;                 ///< scale and swirl
    bool respace = true;
    bool disturb = true;      ///< noise, missed cones and pose error
    bool short_sight = true;  ///< true cones seen to a shorter radius than false ones
    /// A second course beside it, whose cones are false: better among parallel legs, worse elsewhere.
    bool other_course = false;
    double colored_share = 0.5;  ///< of the draws that show colors, at any rates of wrong and unknown ones
    /// Share of the draws that have a scene of false cones alone, for the judge.
    double noise_share = 0.2;
    std::array<std::size_t, 2> noise_cones{4, 60};     ///< fewest and most of such a scene
    std::array<double, 2> noise_ranges_m{15.0, 55.0};  ///< of the half disc that holds them
    double highest_rate = 0.7;  ///< some views reach it if false positives persist at a rate of 0.5
};

/// Scenes for training, drawn from whole courses. Each draw takes a course, drives it in a random direction,
/// may mirror it, scales it, bends it by a smooth swirl, places its cones again along its boundaries and adds
/// another course beside it. It shows the course from a few random poses, with new false positives at any
/// rate, and with or without colors.
class FrontScenes {
  public:
    /// Throws InvalidInput without a course, or if one has no centre line.
    FrontScenes(std::vector<Track> courses, const FrontSceneOptions& options, std::uint64_t seed);

    struct Drawn {
        std::vector<AnnotatedScene> scenes;  ///< with a ground truth; possibly none
        TrackBoundaries boundaries;
        std::vector<Scene> noise;  ///< false cones alone
    };
    /// Depends only on the number: not on earlier draws or on the thread.
    [[nodiscard]] Drawn draw(std::uint64_t number) const;

  private:
    struct Course {
        Track track;
        std::vector<Pose> poses;
    };
    std::vector<Course> courses_;
    FrontSceneOptions options_;
    std::uint64_t seed_;
};

}  // namespace conelane::experiments
