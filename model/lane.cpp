#include "conelane/lane.hpp"

#include "model/geometry.hpp"

#include <unordered_map>
#include <unordered_set>

namespace conelane {

void even_far_ends(Lane& lane, const Scene& scene, double widest_m) {
    if (lane.closed) return;
    std::unordered_map<ConeId, Point> position_of;
    for (const Cone& cone : scene.cones) position_of.emplace(cone.id, cone.position);
    const auto polyline = [&](const std::vector<ConeId>& run) {
        std::vector<Point> vertices;
        for (const ConeId id : run) vertices.push_back(position_of.at(id));
        return vertices;
    };
    std::vector<Point> left = polyline(lane.left);
    std::vector<Point> right = polyline(lane.right);
    const auto last_too_far = [widest_m](const std::vector<Point>& run, const std::vector<Point>& other) {
        return foot_on_polyline(run.back(), other).distance_m > widest_m;
    };
    while (!left.empty() && !right.empty()) {
        if (last_too_far(left, right)) {
            left.pop_back();
        } else if (last_too_far(right, left)) {
            right.pop_back();
        } else {
            break;
        }
    }
    lane.left.resize(left.size());
    lane.right.resize(right.size());
}

Lane cut_to_nearest(Lane lane, const Scene& scene, std::size_t nearest, double widest_m) {
    std::unordered_set<ConeId> inside;
    for (const Cone& cone : nearest_ahead(scene, nearest).cones) inside.insert(cone.id);
    for (std::vector<ConeId>* run : {&lane.left, &lane.right}) {
        const auto first_outside =
            std::ranges::find_if(*run, [&](ConeId id) { return !inside.contains(id); });
        if (first_outside != run->end()) lane.closed = false;
        run->erase(first_outside, run->end());
    }
    even_far_ends(lane, scene, widest_m);
    return lane;
}

}  // namespace conelane
