#pragma once

#include "evaluation/world/annotated_scene.hpp"
#include "evaluation/world/track.hpp"
#include "learning/training/option_field.hpp"
#include "learning/training/training_loop.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace conelane::learning {

/// Which of the changes to a course are made; see option_fields.
struct FrontSceneOptions {
    std::size_t scenes_per_draw = 4;
    bool warp = true;  ///< scale and swirl
    bool respace = true;
    bool disturb = true;
    bool short_sight = true;
    bool other_course = false;
    double colored_share = 0.5;  ///< of the draws that show colors, at any rates of wrong and unknown ones
    double noise_share = 0.2;
    std::array<std::size_t, 2> noise_cones{4, 60};
    std::array<double, 2> noise_ranges_m{15.0, 55.0};
    double highest_rate = 0.7;  ///< some views reach it if false positives persist at a rate of 0.5
};

/// Options of every training on such scenes.
struct DrawnTrainingOptions {
    FrontSceneOptions scenes;
    std::size_t draws_per_step = 8;
    std::uint64_t seed = 0;
    std::size_t report_every = 100;  ///< steps
    unsigned threads = 1;            ///< the result is the same with any number
    std::string checkpoint;          ///< file to resume from, written regularly; none if empty
    std::size_t checkpoint_every = 200;
};
/// Of the draws: the first ones of a record. `with_noise`: with scenes of false cones alone.
[[nodiscard]] OptionFields draw_fields(DrawnTrainingOptions& options, bool with_noise);
/// How it is run; no result depends on these. `report_option`: its name.
[[nodiscard]] OptionFields run_fields(DrawnTrainingOptions& options, const char* report_option);
[[nodiscard]] LearningLoop loop_of(const DrawnTrainingOptions& options, double smallest_deviation,
                                   std::string identity, bool reports);

/// The tracks of SPECs of load_tracks, without those that have no annotated boundaries.
[[nodiscard]] std::vector<Track> annotated_tracks(const std::vector<std::string>& specs);

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

}  // namespace conelane::learning
