#include "experiments/studies/cone_sets.hpp"

#include <algorithm>
#include <cmath>

namespace conelane::experiments {

std::vector<const AnnotatedScene*> scenes_of_size(std::span<const AnnotatedScene> scenes, std::size_t size,
                                                  std::optional<std::size_t> limit,
                                                  const std::function<bool(const AnnotatedScene&)>& wanted) {
    std::vector<const AnnotatedScene*> all;
    for (const AnnotatedScene& scene : scenes) {
        if (nearest_ahead(scene.scene, size).cones.size() == size && wanted(scene)) all.push_back(&scene);
    }
    if (!limit || all.size() <= *limit) return all;
    std::vector<const AnnotatedScene*> some;
    for (std::size_t i = 0; i < *limit; ++i) some.push_back(all[i * all.size() / *limit]);
    return some;
}

double relative_gap(double objective, double optimum) {
    return std::max(0.0, objective - optimum) / std::max(1.0, std::abs(optimum));
}

}  // namespace conelane::experiments
