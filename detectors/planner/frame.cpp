#include "detectors/planner/frame.hpp"

#include "conelane/invalid_input.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace conelane {

Scene checked_scene(const Frame& frame, const DetectionLimits& limits) {
    if (!std::isfinite(frame.time_s)) throw InvalidInput("time_s", "is not finite");
    if (std::isnan(limits.time_limit_ms)) throw InvalidInput("time_limit_ms", "is not a number");
    Scene scene{"frame", frame.pose, frame.cones};
    std::vector<ConeId> used;
    for (const Cone& cone : frame.cones) {
        if (cone.id != kNoId) used.push_back(cone.id);
    }
    std::ranges::sort(used);
    ConeId next = 0;
    for (Cone& cone : scene.cones) {
        if (cone.id != kNoId) continue;
        while (std::ranges::binary_search(used, next)) ++next;
        cone.id = next++;
    }
    validate(scene);
    return scene;
}

void validate_shared(const PlannerOptions& options) {
    if (!(options.max_age_s >= 0.0)) throw InvalidInput("max_age_s", "must be at least 0");
    static_cast<void>(drivable(Lane{}, Scene{}, options.drivable));  // throws if an option is out of range
}

}  // namespace conelane
