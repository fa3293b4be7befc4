#pragma once

#include "conelane/detectors.hpp"
#include "conelane/rld_detector.hpp"
#include "conelane/rld_solver.hpp"
#include "detectors/parameters/parameter_files.hpp"
#include "graph_search/weights/weight_files.hpp"

#include <array>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <variant>

namespace conelane {

struct FrontOptions;

/// RLD: a solver, the cones it is shown, the costs it minimises.
struct RldRecipe {
    std::unique_ptr<RldSolver> (*make_solver)();
    ConeSet cones;
    bool shape_costs = false;             ///< adds the costs of a lane's shape where the parameters have none
    std::string_view parameter_set = {};  ///< of rld_parameter_set, in place of the defaults
};

/// `front`, whose weights may be replaced.
struct FrontRecipe {
    FrontOptions (*options)();
};

/// Any other detector: what makes it.
struct OtherRecipe {
    std::unique_ptr<LaneDetector> (*make)();
};

/// What a detector has learned from. It has no default: no detector of a table can lack it.
class LearnedFrom {
  public:
    using WeightFiles = std::span<const std::string_view* const>;

    /// `weights`: shipped weight files, whose records name their courses. `courses`: further courses, which
    /// were in view when parameters were set.
    constexpr explicit LearnedFrom(WeightFiles weights, std::span<const std::string_view> courses = {})
        : weights_(weights), courses_(courses) {}
    static constexpr LearnedFrom nothing() { return LearnedFrom({}); }

    [[nodiscard]] constexpr WeightFiles weights() const { return weights_; }
    [[nodiscard]] constexpr std::span<const std::string_view> courses() const { return courses_; }

  private:
    WeightFiles weights_;
    std::span<const std::string_view> courses_;
};

// For tables of detectors.
inline constexpr std::array kFrontWeights{&kFrontFile};
inline constexpr std::array kLearnedRldWeights{&kLearnedWeightsFile};
inline constexpr std::array kPaperClcWeights{&kRankNetPaperFile};
inline constexpr std::array kClcRankWeights{&kRankNetExtendedFile};
inline constexpr std::array kClcWeights{&kRankNetExtendedFile, &kStepScoresFile};

/// How a detector of a name is made, and all that is known of it.
struct DetectorRecipe {
    std::string_view name;
    std::string_view description;
    LearnedFrom learned_from;
    ClosedLanes closed_lanes;
    ColorUse color_use;
    std::variant<RldRecipe, FrontRecipe, OtherRecipe> how;

    /// Whether it optimises the RLD objective.
    [[nodiscard]] bool is_rld() const { return std::holds_alternative<RldRecipe>(how); }
    /// Whether its weights may be replaced.
    [[nodiscard]] bool takes_weights() const { return std::holds_alternative<FrontRecipe>(how); }
};

/// The detectors of the library.
[[nodiscard]] std::span<const DetectorRecipe> detector_recipes();

/// The courses that a detector has learned from, by the names that tracks have: those that the records of its
/// weights name, and those that were in view when its parameters were set. Empty where it has seen none.
[[nodiscard]] std::set<std::string> training_courses(const DetectorRecipe& recipe);

/// The options without those that the detector does not use: for where several detectors get the same.
[[nodiscard]] DetectorOptions options_used_by(const DetectorRecipe& recipe, DetectorOptions options);

/// Throws InvalidInput naming the option that is out of range, not used or cannot be read.
[[nodiscard]] std::unique_ptr<LaneDetector> make_detector(const DetectorRecipe& recipe,
                                                          const DetectorOptions& options = {});

/// The cones that the detector is shown and answers for under these options.
[[nodiscard]] ConeSet cone_set(const DetectorRecipe& recipe, const DetectorOptions& options);

/// The parameters that it minimises by; the defaults where the recipe is no RLD.
[[nodiscard]] RldParameters rld_parameters(const DetectorRecipe& recipe, const DetectorOptions& options);

}  // namespace conelane
