#include "conelane/detectors.hpp"

#include "conelane/invalid_input.hpp"
#include "detectors/recipe.hpp"

#include <algorithm>
#include <string>

namespace conelane {

std::vector<DetectorInfo> detectors() {
    std::vector<DetectorInfo> all;
    for (const DetectorRecipe& recipe : detector_recipes()) {
        all.push_back({recipe.name, recipe.description, recipe.closed_lanes, recipe.color_use});
    }
    return all;
}

std::unique_ptr<LaneDetector> make_detector(std::string_view name, const DetectorOptions& options) {
    const auto recipe = std::ranges::find(detector_recipes(), name, &DetectorRecipe::name);
    if (recipe != detector_recipes().end()) return make_detector(*recipe, options);
    std::string names;
    for (const DetectorRecipe& known : detector_recipes()) {
        names += (names.empty() ? "" : ", ") + std::string(known.name);
    }
    throw InvalidInput("detector", "there is no detector '" + std::string(name) + "', only " + names);
}

}  // namespace conelane
