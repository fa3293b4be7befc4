#include "conelane/scene.hpp"

#include "conelane/invalid_input.hpp"
#include "model/geometry.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_set>
#include <utility>

namespace conelane {
namespace {

constexpr const char* kNotFinite = "must be a finite number";

std::string key_of(std::size_t cone, const char* member) {
    return "cones[" + std::to_string(cone) + "]." + member;
}

}  // namespace

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
    // Keys are put together only for a fault: this runs in every call of a detector.
    if (!std::isfinite(scene.pose.position.x())) throw InvalidInput("pose.x", kNotFinite);
    if (!std::isfinite(scene.pose.position.y())) throw InvalidInput("pose.y", kNotFinite);
    if (!std::isfinite(scene.pose.yaw_rad)) throw InvalidInput("pose.yaw", kNotFinite);
    for (std::size_t i = 0; i < scene.cones.size(); ++i) {
        const Cone& cone = scene.cones[i];
        if (!std::isfinite(cone.position.x())) throw InvalidInput(key_of(i, "x"), kNotFinite);
        if (!std::isfinite(cone.position.y())) throw InvalidInput(key_of(i, "y"), kNotFinite);
        if (!(cone.confidence >= 0.0 && cone.confidence <= 1.0)) {
            throw InvalidInput(key_of(i, "confidence"), "must be in [0, 1]");
        }
    }
    ids.clear();
    for (const Cone& cone : scene.cones) ids.push_back(cone.id);
    std::ranges::sort(ids);
    if (std::ranges::adjacent_find(ids) == ids.end()) return;
    std::unordered_set<ConeId> seen;
    for (std::size_t i = 0; i < scene.cones.size(); ++i) {
        if (seen.insert(scene.cones[i].id).second) continue;
        throw InvalidInput(key_of(i, "id"),
                           "cone id " + std::to_string(scene.cones[i].id) + " is there twice");
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
