#include "model/scene.hpp"

#include "model/invalid_input.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_set>
#include <utility>

namespace conelane {

Point Pose::heading() const {
    return {std::cos(yaw_rad), std::sin(yaw_rad)};
}

double Pose::ahead_m(const Point& point) const {
    return heading().dot(point - position);
}

double Pose::left_m(const Point& point) const {
    return cross(heading(), point - position);
}

std::string_view to_string(ConeColor color) {
    switch (color) {
        case ConeColor::blue:
            return "blue";
        case ConeColor::yellow:
            return "yellow";
        case ConeColor::orange:
            return "orange";
        case ConeColor::unknown:
            break;
    }
    return "unknown";
}

void validate(const Scene& scene) {
    const auto require_finite = [](double value, const std::string& key) {
        if (!std::isfinite(value)) throw InvalidInput(key, "must be a finite number");
    };
    require_finite(scene.pose.position.x(), "pose.x");
    require_finite(scene.pose.position.y(), "pose.y");
    require_finite(scene.pose.yaw_rad, "pose.yaw");
    std::unordered_set<ConeId> seen;
    for (std::size_t i = 0; i < scene.cones.size(); ++i) {
        const Cone& cone = scene.cones[i];
        const std::string key = "cones[" + std::to_string(i) + "].";
        require_finite(cone.position.x(), key + "x");
        require_finite(cone.position.y(), key + "y");
        if (!(cone.confidence >= 0.0 && cone.confidence <= 1.0)) {
            throw InvalidInput(key + "confidence", "must be in [0, 1]");
        }
        if (!seen.insert(cone.id).second) {
            throw InvalidInput(key + "id", "cone id " + std::to_string(cone.id) + " is there twice");
        }
    }
}

Scene nearest_ahead(const Scene& scene, std::size_t count) {
    struct Candidate {
        double squared_distance;
        ConeId id;
        std::size_t index;
        auto operator<=>(const Candidate&) const = default;
    };
    std::vector<Candidate> ahead;
    for (std::size_t i = 0; i < scene.cones.size(); ++i) {
        const Cone& cone = scene.cones[i];
        if (scene.pose.ahead_m(cone.position) >= 0.0) {
            ahead.push_back({(cone.position - scene.pose.position).squaredNorm(), cone.id, i});
        }
    }
    count = std::min(count, ahead.size());
    std::ranges::nth_element(ahead, ahead.begin() + static_cast<std::ptrdiff_t>(count));
    ahead.resize(count);
    std::ranges::sort(ahead, {}, &Candidate::index);
    Scene nearest{scene.id, scene.pose, {}};
    nearest.cones.reserve(count);
    for (const Candidate& candidate : ahead) nearest.cones.push_back(scene.cones[candidate.index]);
    return nearest;
}

}  // namespace conelane
