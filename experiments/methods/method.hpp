#pragma once

#include "detectors/recipe.hpp"
#include "evaluation/formats/lane_file.hpp"
#include "evaluation/outside/outside_detector.hpp"
#include "evaluation/world/scene_generation.hpp"

#include <functional>

namespace conelane {
class OutsideProgramPool;
}

namespace conelane::experiments {

/// The data that a detector learns from, and the amount of work.
struct LearningOptions {
    std::vector<std::string> tracks;  ///< SPECs of load_tracks
    SceneOptions scenes;              ///< with the seed of all draws, and the number of threads
    std::size_t variants = 1;         ///< of each track, for networks
    std::size_t evaluations = 60;     ///< number of parameter sets that tuning tries, on every fourth pose
    double front_steps = 1.0;         ///< length of the training of `front`, as a share of the default one
    double rld_steps = 1.0;           ///< the same of `rld-learned` and `rld-strip`, of the shipped training
    /// Folder of the files that the detectors have learned without colors. Empty: they learn these first.
    std::filesystem::path without_colors;
};

/// The files of the weights of front and of rld-strip in the folder of a fold.
inline constexpr std::string_view kFrontFoldFile = "front.json";
inline constexpr std::string_view kStripFoldFile = "rld-strip.json";

using DetectorFactory = std::function<std::unique_ptr<LaneDetector>()>;

/// How a detector gets weights or parameters from courses: by the recipe of the shipped ones. If the scenes
/// have colors, the detectors that use them learn those in a second stage: `front` its set for colors,
/// `rld-learned` its costs on draws that show colors too, and `rld-shape` chooses w_color.
struct Learner {
    /// Learns and writes its files to the folder. Existing files are not learned again, so detectors share
    /// them and a stopped run resumes. Throws InputError or InvalidInput.
    void (*learn)(const LearningOptions& options, const std::filesystem::path& folder);
    /// What the files hold: parameters of RLD for the recipe, or else how to make the detector. Throws
    /// InputError if one is missing or invalid.
    std::variant<DetectorFactory, RldParameters> (*load)(const DetectorRecipe& recipe,
                                                         const std::filesystem::path& folder);
};

/// The learner of a detector; null if it learns nothing.
[[nodiscard]] const Learner* find_learner(const DetectorRecipe& recipe);

/// A method that answers scene after scene, each timed in the same way: from the scene in memory to the lane
/// in memory, on the wall clock.
class TimedDetector {
  public:
    virtual ~TimedDetector() = default;
    [[nodiscard]] virtual LaneRecord answer(const Scene& scene) = 0;
    /// Answers the scene untimed and forgets it, so that no latency includes the loading of code.
    virtual void warm_up(const Scene& scene) = 0;
    /// Another lap begins.
    virtual void reset() = 0;
};

/// Makes the detector for a lap of the course of this name, in any thread.
using DetectorMaker = std::function<std::unique_ptr<TimedDetector>(const std::string& track)>;

struct RunOptions {
    DetectorOptions detector;  ///< without `nearest`, which a method has; a method gets those that it uses
    DetectionLimits limits{.time_limit_ms = std::numeric_limits<double>::infinity()};
    /// One thread runs on one processor. With more threads, contention disturbs the latencies.
    unsigned threads = 1;
    bool show_progress = true;
};

/// What a text of `--method` or `--methods` names. The text is resolved once, by parse_method; everything
/// that compares, races or cross-validates methods takes this.
struct Method {
    std::string name;                             ///< as tables show it
    const DetectorRecipe* recipe = nullptr;       ///< of a detector of this program
    std::optional<OutsideDetector> outside = {};  ///< of any other
    std::optional<std::size_t> nearest = {};      ///< cone-set size that replaces its own
    const Learner* learner = nullptr;  ///< null if it learns nothing: its answers are the same in every fold
    /// The processes of a program from outside. They run from lap to lap, as long as a copy of this exists.
    std::shared_ptr<OutsideProgramPool> programs = {};
    /// Replaces `maker`, for example by detectors that have not seen the course.
    std::function<DetectorMaker(const RunOptions&)> maker_of_folds = {};

    [[nodiscard]] bool is_lanes_file() const { return outside && outside->is_lanes_file(); }
    /// Whether it has the parameters of the RLD objective.
    [[nodiscard]] bool is_rld() const {
        return recipe != nullptr ? recipe->is_rld() : outside && outside->is_solver();
    }
    [[nodiscard]] bool takes_weights() const { return recipe != nullptr && recipe->takes_weights(); }
    /// The name of its weights in the folder of a fold. It must take weights.
    [[nodiscard]] std::string_view weights_file_of_fold() const {
        return std::holds_alternative<StripRecipe>(recipe->how) ? kStripFoldFile : kFrontFoldFile;
    }
    /// The RLD parameters under these options; a solver from outside has the defaults.
    [[nodiscard]] RldParameters rld_parameters(const DetectorOptions& options) const;

    /// How its detectors are made. If the independent checker rejects a lane of RLD, its status becomes error
    /// (see check_answer; not timed). A program from outside is timed by its round trip, gets only the
    /// cone-set size of the options, and has limits of its own (see OutsideLimits). The time of a solver from
    /// outside includes writing the files and reading the solution; each lap starts it again, untimed. Throws
    /// InvalidInput if the command of a solver is invalid. `recipe` must outlive the result.
    [[nodiscard]] DetectorMaker maker(const RunOptions& options) const;
    /// The same with the files in a folder that its learner wrote. Throws InputError if one is missing or
    /// invalid.
    [[nodiscard]] DetectorMaker learned_maker(const std::filesystem::path& folder,
                                              const RunOptions& options) const;
};

/// All detectors of this program, those of the library first.
[[nodiscard]] std::span<const Method> known_methods();

/// Null if there is none of that name.
[[nodiscard]] const Method* known_method(std::string_view name);

/// Throws InvalidInput naming the method if there is none of that name.
[[nodiscard]] const Method& find_method(std::string_view name);

/// The courses that the detector of that name has learned from; empty if it has learned from none, or if
/// there is no such detector.
[[nodiscard]] std::set<std::string> training_courses(std::string_view name);

/// The method of a text: a name, or one from outside (see parse_outside_detector). Throws InvalidInput if
/// there is none of that name, if the name of one from outside belongs to a detector of this program, or if a
/// finished lanes file is given a cone-set size; InputError if its card is invalid.
[[nodiscard]] Method parse_method(const std::string& text, std::optional<std::size_t> nearest = {});

}  // namespace conelane::experiments
