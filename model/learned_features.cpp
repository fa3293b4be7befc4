#include "model/learned_features.hpp"

#include "model/geometry.hpp"
#include "model/shape_costs.hpp"

namespace conelane {
namespace {

// Scales and limits of the features, defined in formulation.md.
constexpr double kMaxSpacingCost = 7.0;
constexpr double kMaxHeadingCost = 4.0;
constexpr double kMaxTurnCost = 4.0;
constexpr double kMaxStretch = 4.0;
constexpr double kGapBegins_m = 5.0;
constexpr double kGapScale_m = 3.0;
constexpr double kBeside_m = 1.2;
constexpr double kMaxCount = 2.0;
constexpr double kCrowd_m = 3.5;
constexpr double kMaxCrowd = 6.0;
constexpr double kCrowdScale = 2.0;
constexpr double kLaneBegins_m = 0.6;
constexpr double kLaneEnds_m = 2.6;
constexpr double kRamp_m = 0.4;
constexpr double kAlongRamp = 8.0;
constexpr double kDistanceScale_m = 30.0;
constexpr double kMaxDistance = 2.0;
constexpr double kLengthScale_m = 8.0;
constexpr double kMaxLength = 3.0;
constexpr double kMinChord_m = 0.1;
constexpr double kCurvatureScale_m = 5.0;
constexpr double kMaxCurvature = 3.0;
constexpr double kOn_m = 6.0;
constexpr double kOnRamp_m = 2.0;
constexpr double kMaxOn = 3.0;
constexpr double kViewScale_m = 10.0;
/// How far the car sees follows from its farthest cone. From 10 m before this distance on, and behind the
/// car, a cone counts less and less; no sensor sees so far.
constexpr double kBeyondView_m = 70.0;
constexpr double kEndScale_m = 6.0;
constexpr double kMaxEndDistance = 2.0;
constexpr double kMaxOffAxis = 3.0;
/// Cones farther apart than this are in no triangle of two short edges, and not beside the same end.
constexpr double kAround_m = 6.0;

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

}  // namespace

LearnedFeatures::LearnedFeatures(const Scene& scene, const LaneGraphProblem& problem,
                                 const std::function<bool(std::size_t)>& stop)
    : scene_(&scene), problem_(&problem) {
    const std::size_t n = problem.cone_count;
    position_.reserve(n);
    for (std::size_t i = 0; i < n; ++i) position_.push_back(scene.cones[i].position);
    distance_m_.resize(n);
    ahead_m_.resize(n);
    cone_crowd_.resize(n);
    around_.resize(n);
    around_edges_.resize(n);
    double longest_squared = 0.0;
    for (const ProblemEdge& edge : problem.edges) {
        if (!edge.high_cost)
            longest_squared = std::max(longest_squared, (at(edge.j) - at(edge.i)).squaredNorm());
    }
    for (std::size_t i = 0; i < n; ++i) {
        distance_m_[i] = (at(i) - scene.pose.position).norm();
        ahead_m_[i] = scene.pose.ahead_m(at(i));
        view_m_ = std::max(view_m_, distance_m_[i] * ramp((kBeyondView_m - distance_m_[i]) / kViewScale_m) *
                                        ramp(1.0 + ahead_m_[i] / kViewScale_m));
    }
    for (std::size_t i = 0; i < n; ++i) {
        if (stop && stop(2 * n)) return;
        cone_crowd_[i] = crowd(at(i), i, i);
        for (std::size_t k = 0; k < n; ++k) {
            const double squared = (at(k) - at(i)).squaredNorm();
            if (k != i && squared <= square(kAround_m)) around_[i].push_back(k);
            if (k != i && squared <= longest_squared) around_edges_[i].push_back(k);
        }
    }
    facing_ = facing_at_any_width(scene, problem.edges, problem.facers, stop);
}

double LearnedFeatures::crowd(const Point& place, std::size_t without, std::size_t and_without) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < problem_->cone_count; ++k) {
        if (k != without && k != and_without) sum += hat((at(k) - place).squaredNorm(), kCrowd_m);
    }
    return std::min(sum, kMaxCrowd) / kCrowdScale;
}

std::array<double, kEdgeFeatures> LearnedFeatures::edge(std::size_t number) const {
    const ProblemEdge& edge = problem_->edges[number];
    const RldParameters& p = problem_->parameters;
    const Point& from = at(edge.i);
    const Point v = at(edge.j) - from;
    const double length = v.norm();
    const Point middle = from + 0.5 * v;
    const double distance = (middle - scene_->pose.position).norm();
    const double reach_squared = square(std::max(kCrowd_m, kLaneEnds_m + 0.5 * length));
    double beside = 0.0;
    double crowded = 0.0;
    std::array<double, 2> in_lane{};  // to the right and to the left
    for (std::size_t k = 0; k < problem_->cone_count; ++k) {
        if (k == edge.i || k == edge.j) continue;
        const double squared = (at(k) - middle).squaredNorm();
        if (squared > reach_squared) continue;
        crowded += hat(squared, kCrowd_m);
        const Point way = at(k) - from;
        const double along = way.dot(v) / square(length);
        if (along <= 0.0 || along >= 1.0) continue;
        const double across = cross(v, way) / length;
        const double hump = along * (1.0 - along);
        beside += hat(square(across), kBeside_m) * 4.0 * hump;
        const double off = std::abs(across);
        in_lane[across > 0.0 ? 1 : 0] += ramp(kAlongRamp * hump) * ramp((off - kLaneBegins_m) / kRamp_m) *
                                         ramp((kLaneEnds_m - off) / kRamp_m);
    }
    const Cone& a = scene_->cones[edge.i];
    const Cone& b = scene_->cones[edge.j];
    const bool same_color =
        a.color == b.color && (a.color == ConeColor::blue || a.color == ConeColor::yellow);
    return {1.0,
            std::min(edge.spacing_cost, kMaxSpacingCost),
            std::min(edge.heading_cost, kMaxHeadingCost),
            edge.facing_cost,
            facing_[number],
            std::max(0.0, length - kGapBegins_m) / kGapScale_m,
            std::min(std::abs(length - p.d_e) / p.d_t, kMaxStretch),
            std::min(beside, kMaxCount),
            std::min(crowded, kMaxCrowd) / kCrowdScale,
            std::min({in_lane[0], in_lane[1], kMaxCount}),
            std::min(distance / kDistanceScale_m, kMaxDistance),
            std::abs(scene_->pose.left_m(middle)) / (distance + 1.0),
            edge.color_cost,
            same_color ? 1.0 : 0.0,
            1.0 - a.confidence * b.confidence};
}

std::array<double, kTurnFeatures> LearnedFeatures::turn(std::size_t edge_i, std::size_t edge_k,
                                                        std::size_t middle, double angle_cost) const {
    const RldParameters& p = problem_->parameters;
    const ProblemEdge& first = problem_->edges[edge_i];
    const ProblemEdge& second = problem_->edges[edge_k];
    const std::size_t i = first.i == middle ? first.j : first.i;
    const std::size_t k = second.i == middle ? second.j : second.i;
    const Point back = at(i) - at(middle);
    const Point on = at(k) - at(middle);
    const Point chord = at(k) - at(i);
    const double back_m = back.norm();
    const double on_m = on.norm();
    const double chord_m = chord.norm();
    const double doubled_area = cross(back, on);
    double inside = 0.0;
    if (std::abs(doubled_area) > 0.0) {
        const double side = doubled_area > 0.0 ? 1.0 : -1.0;
        const auto count = [&](std::size_t cone) {
            if (cone == i || cone == k || cone == middle) return;
            const Point way = at(cone) - at(middle);
            const double from_back = side * cross(back, way);
            const double from_on = side * cross(way, on);
            const double from_chord = side * cross(chord, at(cone) - at(k));
            if (from_back <= 0.0 || from_on <= 0.0 || from_chord <= 0.0) return;
            inside += ramp(std::min({from_back / back_m, from_on / on_m, from_chord / chord_m}) / kRamp_m);
        };
        // No point of the triangle is farther from the middle cone than one of the other two.
        const bool is_short = std::max(back_m, on_m) <= kAround_m;
        for (const std::size_t cone : (is_short ? around_ : around_edges_)[middle]) count(cone);
    }
    const double angle = std::sqrt(std::sqrt(angle_cost));
    const auto gap = [](double length) { return std::max(0.0, length - kGapBegins_m); };
    const double beyond = (gap(back_m) + gap(on_m)) / kGapScale_m;
    const double facing_i = first.facing_cost;
    const double facing_k = second.facing_cost;
    return {1.0,
            std::min(angle_cost, kMaxTurnCost),
            std::min(unevenness(back_m, on_m, p), kMaxTurnCost),
            std::min(angle, kMaxTurnCost),
            std::min(square(angle), kMaxTurnCost),
            std::min(inside, kMaxCount),
            std::min((back_m + on_m) / kLengthScale_m, kMaxLength),
            beyond,
            std::min(angle * beyond, kMaxTurnCost),
            0.5 * (facing_i + facing_k),
            std::abs(facing_i - facing_k),
            cone_crowd_[middle],
            std::min(distance_m_[middle] / kDistanceScale_m, kMaxDistance),
            std::min(kCurvatureScale_m * 2.0 * std::abs(doubled_area) /
                         (back_m * on_m * std::max(chord_m, kMinChord_m)),
                     kMaxCurvature)};
}

std::array<double, kNearEndFeatures> LearnedFeatures::near_end(std::size_t cone) const {
    const RldParameters& p = problem_->parameters;
    double behind = 0.0;
    for (const std::size_t k : around_[cone])
        behind +=
            hat((at(k) - at(cone)).squaredNorm(), kOn_m) * ramp((ahead_m_[cone] - ahead_m_[k]) / kOnRamp_m);
    const double off_m = std::abs(std::abs(scene_->pose.left_m(at(cone))) - 0.5 * p.lane_width_m);
    return {1.0,
            near_end_fit(*scene_, at(cone), p),
            std::min(off_m / p.d_t, kMaxOffAxis),
            std::clamp(ahead_m_[cone] / kEndScale_m, -1.0, kMaxEndDistance),
            std::min(distance_m_[cone] / kEndScale_m, kMaxEndDistance),
            std::min(behind, kMaxOn),
            cone_crowd_[cone]};
}

std::array<double, kFarEndFeatures> LearnedFeatures::far_end(std::size_t cone) const {
    double beyond = 0.0;
    for (const std::size_t k : around_[cone])
        beyond += hat((at(k) - at(cone)).squaredNorm(), kOn_m) *
                  ramp((distance_m_[k] - distance_m_[cone]) / kOnRamp_m);
    return {1.0,
            std::min(distance_m_[cone] / kDistanceScale_m, kMaxDistance),
            ramp((view_m_ - distance_m_[cone]) / kViewScale_m),
            std::min(beyond, kMaxOn),
            cone_crowd_[cone],
            std::abs(scene_->pose.left_m(at(cone))) / (distance_m_[cone] + 1.0)};
}

}  // namespace conelane
