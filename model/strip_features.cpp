#include "model/strip_features.hpp"

#include "model/geometry.hpp"

namespace conelane {
namespace {

// Scales and limits of the features.
constexpr double kWidth_m = 3.7;
constexpr double kCrowd_m = 3.5;
constexpr double kRamp_m = 0.4;
constexpr double kLaneEnds_m = 2.6;
constexpr double kGapBegins_m = 5.0;
constexpr double kGapScale_m = 3.0;
constexpr double kSharp_rad = 0.8;
constexpr double kMinChord_m = 0.1;
constexpr double kBeyondView_m = 70.0;
constexpr double kViewScale_m = 10.0;
constexpr double kOn_m = 7.5;  ///< a cone that goes on after an edge is not farther from its end

double square(double value) {
    return value * value;
}
/// 1 at 0, and 0 from the scale on.
double hat(double squared, double scale) {
    return std::max(0.0, 1.0 - squared / square(scale));
}
double ramp(double value) {
    return std::clamp(value, 0.0, 1.0);
}
double gap(double length_m) {
    return std::max(0.0, length_m - kGapBegins_m) / kGapScale_m;
}

/// How far points are inside a triangle.
class Depth {
  public:
    Depth(const Point& a, const Point& b, const Point& c)
        : corners_{a, b, c}, sides_{b - a, c - b, a - c}, side_(cross(b - a, c - a) > 0.0 ? 1.0 : -1.0) {}
    /// From its nearest side [m]; 0 outside.
    [[nodiscard]] double of(const Point& p) const {
        std::array<double, 3> doubled_areas{};
        for (std::size_t k = 0; k < 3; ++k) {
            doubled_areas[k] = side_ * cross(sides_[k], p - corners_[k]);
            if (doubled_areas[k] <= 0.0) return 0.0;
        }
        const auto height = [&](std::size_t k) {
            return doubled_areas[k] / std::max(sides_[k].norm(), kMinChord_m);
        };
        return std::min({height(0), height(1), height(2)});
    }

  private:
    std::array<Point, 3> corners_;
    std::array<Point, 3> sides_;
    double side_;
};

}  // namespace

StripFeatures::StripFeatures(const Scene& scene, const LaneGraphProblem& graph, double reach_m,
                             const std::function<bool()>& stop) {
    const std::size_t n = graph.cone_count;
    const Point heading = scene.pose.heading();
    for (const Cone& cone : scene.cones) {
        const Point at = cone.position - scene.pose.position;
        at_.push_back(at);
        ahead_m_.push_back(at.dot(heading));
        left_m_.push_back(cross(heading, at));
        distance_m_.push_back(at.norm());
        view_m_ =
            std::max(view_m_, distance_m_.back() * ramp((kBeyondView_m - distance_m_.back()) / kViewScale_m) *
                                  ramp(1.0 + ahead_m_.back() / kViewScale_m));
    }
    around_.resize(n);
    const double reach = std::max(reach_m, kOn_m);
    for (std::size_t i = 0; i < n; ++i) {
        if (stop && stop()) return;
        double sum = 0.0;
        for (std::size_t k = 0; k < n; ++k) {
            const double squared = (at_[k] - at_[i]).squaredNorm();
            if (k == i || squared > square(reach)) continue;
            around_[i].push_back({std::sqrt(squared), k});
            sum += hat(squared, kCrowd_m);
        }
        std::ranges::sort(around_[i]);
        crowd_.push_back(std::min(sum, 6.0) / 2.0);
    }
}

std::array<double, kStripEdgeFeatures> StripFeatures::edge(std::size_t i, std::size_t j) const {
    const Point v = at(j) - at(i);
    const double length_m = v.norm();
    const Point middle = at(i) + 0.5 * v;
    double beside = 0.0;
    double wide_beside = 0.0;
    double crowd = 0.0;
    std::array<double, 2> lane{};  // to the right and to the left
    const double reach_squared = square(std::max(kCrowd_m, kLaneEnds_m + 0.5 * length_m));
    for (std::size_t k = 0; k < at_.size(); ++k) {
        const double squared = (at(k) - middle).squaredNorm();
        if (k == i || k == j || squared > reach_squared) continue;
        crowd += hat(squared, kCrowd_m);
        const Point way = at(k) - at(i);
        const double along = way.dot(v) / square(length_m);
        if (along <= 0.0 || along >= 1.0) continue;
        const double across_m = cross(v, way) / length_m;
        const double hump = 4.0 * along * (1.0 - along);
        beside += hat(square(across_m), 1.2) * hump;
        wide_beside += hat(square(across_m), 2.5) * hump;
        lane[across_m > 0.0 ? 1 : 0] += ramp(2.0 * hump) * ramp((std::abs(across_m) - 0.6) / kRamp_m) *
                                        ramp((kLaneEnds_m - std::abs(across_m)) / kRamp_m);
    }
    crowd = std::min(crowd, 6.0) / 2.0;
    return {1.0,
            length_m / 5.0,
            gap(length_m),
            std::min(square((length_m - 4.0) / 2.0), 4.0),
            std::max(0.0, 2.0 - length_m),
            std::min(beside, 2.0),
            crowd,
            gap(length_m) * std::min(wide_beside, 3.0),
            gap(length_m) * crowd,
            length_m / 5.0 * crowd,
            std::min({lane[0], lane[1], 2.0}),
            std::min(middle.norm() / 30.0, 2.0)};
}

std::array<double, kStripTriangleFeatures> StripFeatures::triangle(std::size_t from, std::size_t to,
                                                                   std::size_t across, double inside) const {
    const Point step = at(to) - at(from);
    const Point old_rung = at(across) - at(from);
    const Point new_rung = at(across) - at(to);
    const double length_m = step.norm();
    const double old_m = old_rung.norm();
    const double width_m = new_rung.norm();
    const double off_m = std::abs(width_m - kWidth_m);
    const double change_m = std::abs(width_m - old_m);
    const double lead_before = old_rung.dot(step) / (4.0 * length_m);  // of the other boundary
    const double lead_after = new_rung.dot(step) / (4.0 * length_m);
    const double area_m2 = 0.5 * std::abs(cross(old_rung, new_rung));
    const double rotation = std::atan2(2.0 * area_m2, old_rung.dot(new_rung));
    return {1.0,
            inside,
            std::max(0.0, width_m - 4.5),
            std::max(0.0, 3.2 - width_m),
            off_m,
            std::min(square(off_m), 4.0),
            lead_before,
            square(lead_before),
            lead_after,
            square(lead_after),
            change_m,
            std::min(square(change_m), 9.0),
            std::min(area_m2 / 10.0, 3.0),
            rotation,
            square(rotation),
            std::max(0.0, -lead_before) * std::max(0.0, -lead_after)};
}

std::array<double, kStripStartFeatures> StripFeatures::start(std::size_t left, std::size_t right) const {
    const double width_m = (at(left) - at(right)).norm();
    const double off_m = std::abs(width_m - kWidth_m);
    const double aside_m = 0.5 * std::abs(left_m_[left] + left_m_[right]);
    const double ahead_m = 0.5 * (ahead_m_[left] + ahead_m_[right]);
    const double skew = (ahead_m_[left] - ahead_m_[right]) / 4.0;
    double between = 0.0;
    double behind = 0.0;
    const Point middle = 0.5 * (at(left) + at(right));
    const double reach_m = std::max(distance_m_[left], distance_m_[right]);
    const Depth depth({}, at(left), at(right));
    for (std::size_t k = 0; k < at_.size(); ++k) {
        if (k == left || k == right) continue;
        if (distance_m_[k] < reach_m) between += ramp(depth.of(at(k)) / kRamp_m);
        for (const std::size_t end : {left, right})
            behind += hat((at(k) - at(end)).squaredNorm(), 6.0) * ramp((ahead_m_[end] - ahead_m_[k]) / 2.0);
    }
    return {1.0,
            std::min(aside_m, 6.0),
            std::min(square(aside_m), 9.0),
            std::clamp(ahead_m / 6.0, -1.0, 2.0),
            std::clamp(-ahead_m / 2.0, 0.0, 2.0),
            std::min(square(ahead_m / 6.0), 4.0),
            std::abs(skew),
            std::min(square(skew), 4.0),
            off_m,
            std::min(square(off_m), 4.0),
            std::min(between, 2.0),
            std::min(behind, 4.0),
            crowd(middle, left, right)};
}

std::array<double, kStripTurnFeatures> StripFeatures::turn(std::size_t i, std::size_t j, std::size_t k,
                                                           bool lane_inside) const {
    const Point back = at(i) - at(j);
    const Point on = at(k) - at(j);
    const double back_m = back.norm();
    const double on_m = on.norm();
    const double chord_m = std::max((at(k) - at(i)).norm(), kMinChord_m);
    const double doubled_area = std::abs(cross(back, on));
    const double angle = std::numbers::pi - std::atan2(doubled_area, back.dot(on));
    return {1.0,
            angle,
            square(angle),
            std::max(0.0, angle - kSharp_rad),
            std::min(10.0 * doubled_area / (back_m * on_m * chord_m), 3.0),
            inside_of(j, i, k),
            std::min(square((back_m - on_m) / 2.0), 4.0),
            std::min((back_m + on_m) / 8.0, 3.0),
            lane_inside ? angle : 0.0,
            angle * (gap(back_m) + gap(on_m)),
            crowd_[j]};
}

std::array<double, kStripEndFeatures> StripFeatures::end(std::size_t from, std::size_t to) const {
    const Point step = at(to) - at(from);
    const double length_m = step.norm();
    const Point next = at(to) + step * (std::clamp(length_m, 3.0, 5.0) / length_m);
    double on = 0.0;
    for (const auto& [distance_m, k] : around_[to]) {
        if (distance_m > kOn_m) break;
        if (k != from) on += hat((at(k) - next).squaredNorm(), 2.5);
    }
    const double next_in_view = ramp((view_m_ - next.norm()) / 5.0);
    return {1.0,
            ramp((view_m_ - distance_m_[to]) / kViewScale_m),
            std::min(on, 2.0),
            next_in_view,
            std::min(on, 2.0) * next_in_view,
            std::min(distance_m_[to] / 30.0, 2.0),
            std::abs(left_m_[to]) / (distance_m_[to] + 1.0),
            crowd_[to]};
}

double StripFeatures::inside_of(std::size_t a, std::size_t b, std::size_t c) const {
    // No point of the triangle is farther from the first cone than one of the other two.
    const double longest_m =
        std::sqrt(std::max((at(b) - at(a)).squaredNorm(), (at(c) - at(a)).squaredNorm()));
    const Depth depth(at(a), at(b), at(c));
    double sum = 0.0;
    for (const auto& [distance_m, k] : around_[a]) {
        if (distance_m > longest_m) break;
        if (k != b && k != c) sum += ramp(depth.of(at(k)) / kRamp_m);
    }
    return std::min(sum, 2.0);
}

double StripFeatures::crowd(const Point& place, std::size_t without, std::size_t and_without) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < at_.size(); ++k) {
        if (k != without && k != and_without) sum += hat((at(k) - place).squaredNorm(), kCrowd_m);
    }
    return std::min(sum, 6.0) / 2.0;
}

}  // namespace conelane
