#include "evaluation/world/ground_truth.hpp"

namespace conelane {

std::optional<Lane> ground_truth_of_nearest(const AnnotatedScene& scene, std::size_t nearest) {
    if (!scene.ground_truth) return std::nullopt;
    Lane lane = cut_to_nearest(*scene.ground_truth, scene.scene, nearest);
    if (lane.left.size() < 2 || lane.right.size() < 2) return std::nullopt;
    return lane;
}

}  // namespace conelane
