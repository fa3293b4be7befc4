#include "conelane/detectors.hpp"

#include "conelane/invalid_input.hpp"
#include "detectors/recipe.hpp"

#include <string>

namespace conelane {

std::vector<DetectorInfo> detectors() {
    return {detector_recipes().begin(), detector_recipes().end()};
}

std::unique_ptr<LaneDetector> make_detector(std::string_view name, const DetectorOptions& options) {
    if (const DetectorRecipe* const recipe = find_recipe(name)) return make_detector(*recipe, options);
    std::string names;
    for (const DetectorRecipe& known : detector_recipes()) {
        names += (names.empty() ? "" : ", ") + std::string(known.name);
    }
    throw InvalidInput("detector", "there is no detector '" + std::string(name) + "', only " + names);
}

}  // namespace conelane
