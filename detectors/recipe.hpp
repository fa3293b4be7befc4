#pragma once

#include "conelane/detectors.hpp"
#include "conelane/rld_detector.hpp"
#include "graph_search/weights/weight_files.hpp"

#include <array>
#include <set>

namespace conelane {

// The files in parameters/, byte by byte, embedded when the library was configured.
extern const std::string_view kLearnedWeightsFile;
extern const std::string_view kStripWeightsFile;
/// NAME.json; empty if there is none.
[[nodiscard]] std::string_view parameter_file(std::string_view name);

struct FrontOptions;

/// RLD: a solver, the cones that it sees, the costs that it minimises.
struct RldRecipe {
    std::unique_ptr<RldSolver> (*make_solver)();
    ConeSet cones = {};
    bool shape_costs = false;             ///< adds the costs of a lane's shape if the parameters have none
    std::string_view parameter_set = {};  ///< of rld_parameter_set, in place of the defaults
    std::span<const double> other_d_near_m = {};  ///< see RldDetectorOptions
};

/// `front`, whose weights may be replaced.
struct FrontRecipe {
    FrontOptions (*options)();
};

/// `rld-strip`, whose costs may be replaced.
struct StripRecipe {};

/// Any other detector: the function that makes it.
struct OtherRecipe {
    std::unique_ptr<LaneDetector> (*make)();
};

/// The courses that a detector has learned from. It has no default, so that no detector can lack it.
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

// Text for tables of detectors.
inline constexpr std::array kFrontWeights{&kFrontFile};
inline constexpr std::array kLearnedRldWeights{&kLearnedWeightsFile};
inline constexpr std::array kStripWeights{&kStripWeightsFile};
inline constexpr std::array kPaperClcWeights{&kRankNetPaperFile};
inline constexpr std::array kClcWeights{&kRankNetExtendedFile, &kStepScoresFile};

/// How to make a detector.
struct DetectorRecipe : DetectorInfo {
    LearnedFrom learned_from;
    std::variant<RldRecipe, FrontRecipe, StripRecipe, OtherRecipe> how;

    /// Whether it optimises the RLD objective.
    [[nodiscard]] bool is_rld() const { return std::holds_alternative<RldRecipe>(how); }
    /// Whether its weights may be replaced.
    [[nodiscard]] bool takes_weights() const {
        return std::holds_alternative<FrontRecipe>(how) || std::holds_alternative<StripRecipe>(how);
    }
};

/// The detectors of the library.
[[nodiscard]] std::span<const DetectorRecipe> detector_recipes();

/// Null if the library has none of that name.
[[nodiscard]] const DetectorRecipe* find_recipe(std::string_view name);

/// The courses that a detector has learned from, by the names of the tracks: those in the records of its
/// weights, and those in view when its parameters were set. Empty if it has learned from none.
[[nodiscard]] std::set<std::string> training_courses(const DetectorRecipe& recipe);

/// The options without those that the detector does not use: for one set of options and several detectors.
[[nodiscard]] DetectorOptions options_used_by(const DetectorRecipe& recipe, DetectorOptions options);

/// Throws InvalidInput naming the option that is out of range, not used or cannot be read.
[[nodiscard]] std::unique_ptr<LaneDetector> make_detector(const DetectorRecipe& recipe,
                                                          const DetectorOptions& options = {});

/// A detector that answers drivable lanes among the nearest cones ahead, or among all.
[[nodiscard]] std::unique_ptr<LaneDetector> drivable_lanes_among(std::optional<std::size_t> nearest,
                                                                 std::unique_ptr<LaneDetector> detector);

/// The cones that the detector sees and answers for under these options.
[[nodiscard]] ConeSet cone_set(const DetectorRecipe& recipe, const DetectorOptions& options);

/// The parameters of its objective; the defaults if the recipe is not RLD.
[[nodiscard]] RldParameters rld_parameters(const DetectorRecipe& recipe, const DetectorOptions& options);

}  // namespace conelane
