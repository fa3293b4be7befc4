#pragma once

#include "conelane/detectors.hpp"
#include "conelane/rld_detector.hpp"
#include "conelane/rld_solver.hpp"

#include <array>
#include <memory>
#include <span>
#include <string_view>
#include <variant>

namespace conelane {

struct FrontOptions;

/// RLD: a solver, the cones it is shown, the costs it minimises.
struct RldRecipe {
    std::unique_ptr<RldSolver> (*make_solver)();
    ConeSet cones;
    bool shape_costs = false;  ///< adds the costs of a lane's shape where the parameters have none
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
    /// `weights`: names of shipped weight files, whose records name their courses. `courses`: further
    /// courses, which were in view when parameters were set.
    constexpr explicit LearnedFrom(std::span<const std::string_view> weights,
                                   std::span<const std::string_view> courses = {})
        : weights_(weights), courses_(courses) {}
    static constexpr LearnedFrom nothing() { return LearnedFrom({}); }

    [[nodiscard]] constexpr std::span<const std::string_view> weights() const { return weights_; }
    [[nodiscard]] constexpr std::span<const std::string_view> courses() const { return courses_; }

  private:
    std::span<const std::string_view> weights_;
    std::span<const std::string_view> courses_;
};

// Of shipped weights: for tables of detectors.
inline constexpr std::array<std::string_view, 1> kFrontWeights{"front"};
inline constexpr std::array<std::string_view, 1> kPaperClcWeights{"rank_net_paper"};
inline constexpr std::array<std::string_view, 1> kClcRankWeights{"rank_net_extended"};
inline constexpr std::array<std::string_view, 2> kClcWeights{"rank_net_extended", "step_scores"};

/// How a detector of a name is made, and all that is known of it.
struct DetectorRecipe {
    std::string_view name;
    std::string_view description;
    LearnedFrom learned_from;
    std::variant<RldRecipe, FrontRecipe, OtherRecipe> how;

    /// Whether it optimises the RLD objective.
    [[nodiscard]] bool is_rld() const { return std::holds_alternative<RldRecipe>(how); }
    /// Whether its weights may be replaced.
    [[nodiscard]] bool takes_weights() const { return std::holds_alternative<FrontRecipe>(how); }
};

/// The detectors of the library.
[[nodiscard]] std::span<const DetectorRecipe> detector_recipes();

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
