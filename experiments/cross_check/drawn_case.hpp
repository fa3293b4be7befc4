#pragma once

#include "conelane/formulation.hpp"
#include "conelane/rld_parameters.hpp"
#include "conelane/scene.hpp"
#include "evaluation/world/annotated_scene.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace conelane::experiments {

/// A scene and parameters on which all exact solvers are to agree.
struct CrossCheckCase {
    std::size_t number = 0;
    std::string kind;  ///< one of cross_check_kinds(), or "given"
    Scene scene;       ///< at least one cone
    RldParameters parameters;
    Formulation formulation = Formulation::tight;  ///< of the solvers that use one
    double tight_limit_ms = 1.0;                   ///< time limit of a second solve by each solver
};

/// Kinds of scenes that are made up:
///   lane        a bent lane with false positives
///   strewn      cones strewn at random
///   collinear   all cones on one line or on two parallel ones, evenly spaced
///   lattice     cones at points of a square lattice: ties of every kind
///   coincident  a lane, some of whose cones lie on others or up to 5 cm beside them
///   symmetric   each cone has its mirror image across the car's axis
///   at_limits   a lane, and a parameter that one of its distances, costs or angles meets exactly or nearly
///   far_away    one of the above, 1 km to 10^12 m from the origin
///   scaled      one of the above, 10^-300 to 10^300 times as large, in part with the lengths among the
///   parameters
[[nodiscard]] std::vector<std::string_view> cross_check_kinds();

/// Case `number` of a seed: it depends only on these two and on the given scenes, so a run may be cut into
/// parts. Three of ten cases are the nearest cones of a given scene, if there is one. 1 to 24 cones, mostly 4
/// to 9. Parameters: both pairings, both sets of costs, and in half of the cases any of them drawn from its
/// range.
[[nodiscard]] CrossCheckCase draw_cross_check_case(std::span<const AnnotatedScene> given, std::uint64_t seed,
                                                   std::size_t number);

/// The case with as many cones removed, and as many parameters at their defaults, as `differs` allows: it
/// holds for the result, and not after any further cone is removed. It is called at most `max_trials` times.
/// Precondition: it holds for `drawn`.
[[nodiscard]] CrossCheckCase shrink(CrossCheckCase drawn,
                                    const std::function<bool(const CrossCheckCase&)>& differs,
                                    std::size_t max_trials = 2000);

/// A stored case, to be judged again.
struct StoredCase {
    CrossCheckCase drawn;
    std::vector<std::string> solvers;
    double time_limit_ms = 0.0;  ///< the generous limit
};

/// Writes NAME.scenes.jsonl, NAME.params.json and, if the scene has an edge, NAME.mps, the program in the
/// case's formulation; finally NAME.case.json, which names them and holds the rest and the findings. NAME is
/// the scene's id. Returns its path. Each file appears complete or not at all. Throws InputError.
std::filesystem::path write_case(const std::filesystem::path& directory, const StoredCase& stored,
                                 std::span<const std::string> findings);

/// Reads a NAME.case.json and the files beside it. Throws InputError naming file, line and key.
[[nodiscard]] StoredCase read_case(const std::filesystem::path& file);

}  // namespace conelane::experiments
