#include "conelane/scene.hpp"

#include "conelane/invalid_input.hpp"
#include "model/geometry.hpp"
#include "model/position_covariance.hpp"

#include <unordered_set>
#include <utility>

namespace conelane {
namespace {

constexpr const char* kNotFinite = "must be a finite number";

std::string key_of(std::size_t cone, const char* member) {
    return "cones[" + std::to_string(cone) + "]." + member;
}

void require_probabilities(const ColorProbabilities& given, std::size_t cone) {
    constexpr double kOff = 1e-3;  // more than the rounding error of probabilities with three digits
    double sum = 0.0;
    for (const double value : {given.unknown, given.blue, given.yellow, given.orange, given.big_orange}) {
        if (!(value >= 0.0 && value <= 1.0))
            throw InvalidInput(key_of(cone, "color_probabilities"), "must be in [0, 1]");
        sum += value;
    }
    if (std::abs(sum - 1.0) > kOff)
        throw InvalidInput(key_of(cone, "color_probabilities"), "must add up to 1");
}

void require_covariance(const PositionCovariance& given, std::size_t cone) {
    if (given.is_valid()) return;
    const bool finite =
        std::isfinite(given.xx_m2) && std::isfinite(given.xy_m2) && std::isfinite(given.yy_m2);
    throw InvalidInput(key_of(cone, "position_covariance"),
                       finite ? "must be positive semidefinite" : kNotFinite);
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
    constexpr std::array<std::string_view, 5> kNames{"unknown", "blue", "yellow", "orange", "big_orange"};
    return kNames[static_cast<std::size_t>(color)];
}

ColorProbabilities probabilities_of(ConeColor color) {
    const auto is = [color](ConeColor of) { return color == of ? 1.0 : 0.0; };
    return {is(ConeColor::unknown), is(ConeColor::blue), is(ConeColor::yellow), is(ConeColor::orange),
            is(ConeColor::big_orange)};
}

ConeColor most_probable_color(const ColorProbabilities& probabilities) {
    const std::array<std::pair<double, ConeColor>, 4> labels{
        {{probabilities.unknown, ConeColor::unknown},
         {probabilities.blue, ConeColor::blue},
         {probabilities.yellow, ConeColor::yellow},
         {probabilities.orange + probabilities.big_orange,
          probabilities.big_orange > probabilities.orange ? ConeColor::big_orange : ConeColor::orange}}};
    const auto best = std::ranges::max_element(labels, {}, &std::pair<double, ConeColor>::first);
    const auto is_best = [&](const auto& label) { return label.first == best->first; };
    return std::ranges::count_if(labels, is_best) > 1 ? ConeColor::unknown : best->second;
}

std::optional<PositionCovariance> covariance_of(const std::array<double, 4>& matrix) {
    constexpr double kOff = 1e-6;
    const auto [xx, xy, yx, yy] = matrix;
    if (xy == yx) return PositionCovariance{xx, xy, yy};
    if (!(std::abs(xy - yx) <= kOff * std::max(std::abs(xy), std::abs(yx)))) return std::nullopt;
    return PositionCovariance{xx, 0.5 * xy + 0.5 * yx, yy};
}

bool PositionCovariance::is_valid() const {
    constexpr double kMaxCorrelation = 1.0 + 1e-6;
    if (!(std::isfinite(xx_m2) && std::isfinite(xy_m2) && std::isfinite(yy_m2))) return false;
    // Of the roots, since the product may overflow.
    return xx_m2 >= 0.0 && yy_m2 >= 0.0 &&
           std::abs(xy_m2) <= kMaxCorrelation * std::sqrt(xx_m2) * std::sqrt(yy_m2);
}

double PositionCovariance::along_m2(const Point& direction) const {
    const double variance_m2 = direction.x() * direction.x() * xx_m2 +
                               2.0 * direction.x() * direction.y() * xy_m2 +
                               direction.y() * direction.y() * yy_m2;
    return std::max(0.0, variance_m2);
}

void validate(const Scene& scene) {
    std::vector<ConeId> ids;
    validate(scene, ids);
}

void validate(const Scene& scene, std::vector<ConeId>& ids) {
    // Keys are built only for an error, because this runs in every call of a detector.
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
        if (cone.color_probabilities) require_probabilities(*cone.color_probabilities, i);
        if (cone.position_covariance) require_covariance(*cone.position_covariance, i);
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
