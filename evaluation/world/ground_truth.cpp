#include "evaluation/world/ground_truth.hpp"

#include "model/geometry.hpp"

#include <algorithm>
#include <vector>

namespace conelane {

std::optional<Lane> ground_truth_of_nearest(const AnnotatedScene& scene, std::size_t nearest) {
    if (!scene.ground_truth) return std::nullopt;
    Lane lane = cut_to_nearest(*scene.ground_truth, scene.scene, nearest);
    if (lane.left.size() < 2 || lane.right.size() < 2) return std::nullopt;
    return lane;
}

namespace {

/// Positive if the polygon is counter-clockwise.
double signed_area_m2(const std::vector<Point>& polygon) {
    double twice_m2 = 0.0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        twice_m2 += cross(polygon[i] - polygon[0], polygon[(i + 1) % polygon.size()] - polygon[0]);
    }
    return 0.5 * twice_m2;
}

}  // namespace

bool is_degenerate(const Lane& ground_truth, const Scene& scene) {
    const auto index_of = index_by_id(scene);
    const auto positions = [&](const std::vector<ConeId>& run) {
        std::vector<Point> vertices;
        for (const ConeId id : run) vertices.push_back(scene.cones[index_of.at(id)].position);
        return vertices;
    };
    const std::vector<Point> left = positions(ground_truth.left);
    const std::vector<Point> right = positions(ground_truth.right);
    const bool closed = ground_truth.closed;

    std::vector<double> widths_m;
    for (const Point& cone : left) widths_m.push_back(foot_on_polyline(cone, right, closed).distance_m);
    for (const Point& cone : right) widths_m.push_back(foot_on_polyline(cone, left, closed).distance_m);
    const auto middle = widths_m.begin() + static_cast<std::ptrdiff_t>(widths_m.size() / 2);
    std::ranges::nth_element(widths_m, middle);
    const double length_m = 0.5 * (polyline_length_m(left, closed) + polyline_length_m(right, closed));

    double area_m2 = 0.0;
    if (closed) {
        area_m2 = signed_area_m2(right) - signed_area_m2(left);
    } else {
        std::vector<Point> outline = left;
        outline.insert(outline.end(), right.rbegin(), right.rend());
        area_m2 = -signed_area_m2(outline);
    }
    return area_m2 < kDegenerateAreaShare * length_m * *middle;
}

}  // namespace conelane
