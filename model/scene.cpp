#include "model/scene.hpp"

#include "model/invalid_input.hpp"

#include <algorithm>
#include <cmath>
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
    std::vector<ConeId> ids;
    validate(scene, ids);
}

void validate(const Scene& scene, std::vector<ConeId>& ids) {
    const auto require_finite = [](double value, const char* key) {
        if (!std::isfinite(value)) throw InvalidInput(key, "must be a finite number");
    };
    require_finite(scene.pose.position.x(), "pose.x");
    require_finite(scene.pose.position.y(), "pose.y");
    require_finite(scene.pose.yaw_rad, "pose.yaw");
    const auto refuse = [](std::size_t i, const char* key, const std::string& reason) {
        throw InvalidInput("cones[" + std::to_string(i) + "]." + key, reason);
    };
    ids.clear();
    for (std::size_t i = 0; i < scene.cones.size(); ++i) {
        const Cone& cone = scene.cones[i];
        if (!std::isfinite(cone.position.x())) refuse(i, "x", "must be a finite number");
        if (!std::isfinite(cone.position.y())) refuse(i, "y", "must be a finite number");
        if (!(cone.confidence >= 0.0 && cone.confidence <= 1.0)) refuse(i, "confidence", "must be in [0, 1]");
        ids.push_back(cone.id);
    }
    std::ranges::sort(ids);
    const auto twice = std::ranges::adjacent_find(ids);
    if (twice == ids.end()) return;
    const auto first = std::ranges::find(scene.cones, *twice, &Cone::id);
    const auto second =
        std::find_if(first + 1, scene.cones.end(), [&](const Cone& cone) { return cone.id == *twice; });
    refuse(static_cast<std::size_t>(second - scene.cones.begin()), "id",
           "cone id " + std::to_string(*twice) + " is there twice");
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
