#pragma once

#include "evaluation/scenes/annotated_scene.hpp"
#include "evaluation/tracks/track.hpp"
#include "evaluation/tracks/track_boundaries.hpp"

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
    /// Another course beside it, whose cones are false ones: better among parallel legs, worse elsewhere.
    bool other_course = false;
    double colored_share = 0.5;  ///< of the draws that show colors, wrong and not seen at any rate
    bool noise_scenes = true;    ///< a fifth of the draws has a scene of false cones alone, for the judge
    double highest_rate = 0.7;   ///< some views have so many where false positives stay at a rate of 0.5
};

/// Scenes for training, drawn from whole courses on the fly. Each draw takes a course, drives it either way,
/// mirrors it or not, scales it, bends it by a smooth swirl, places its cones anew along its boundaries, lays
/// another course beside it, and shows it from a few poses anywhere along it, with fresh false positives at
/// any rate, and with colors or without.
class FrontScenes {
  public:
    /// Throws InvalidInput where there is no course, or one has no centre line.
    FrontScenes(std::vector<Track> courses, const FrontSceneOptions& options, std::uint64_t seed);

    struct Drawn {
        std::vector<AnnotatedScene> scenes;  ///< with a ground truth; maybe none
        TrackBoundaries boundaries;
        std::vector<Scene> noise;  ///< false cones alone
    };
    /// The same for the same number, whatever was drawn before and on any thread.
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
