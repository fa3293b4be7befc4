#pragma once

#include "conelane/scene.hpp"

#include <cstddef>
#include <unordered_map>

namespace conelane {

/// The position of each cone in scene.cones by its id; only for look-up, its order is unspecified.
[[nodiscard]] inline std::unordered_map<ConeId, std::size_t> index_by_id(const Scene& scene) {
    std::unordered_map<ConeId, std::size_t> index_of;
    for (std::size_t i = 0; i < scene.cones.size(); ++i) index_of.emplace(scene.cones[i].id, i);
    return index_of;
}

}  // namespace conelane
