#include "model/lane_graph_reference.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace conelane {
namespace {

using Real = LaneGraphReference::Real;

constexpr Real kTie = 1e-9L;
constexpr Real kMinEdge_m = 1e-100L;

Real real(double value) {
    return value;
}

}  // namespace

LaneGraphReference::LaneGraphReference(const Scene& scene, const RldParameters& parameters)
    : scene_(scene),
      p_(parameters),
      car_{scene.pose.position.x(), scene.pose.position.y()},
      heading_{std::cos(real(scene.pose.yaw_rad)), std::sin(real(scene.pose.yaw_rad))} {
    if (p_.facing_weight > 0.0) find_facing_edges();
    if (p_.learned_costs) learned_.emplace(scene_, p_);
}

LaneGraphReference::Vector LaneGraphReference::along(const Vector& a, const Vector& b, Real t) {
    return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
}

Real LaneGraphReference::length(const Vector& a) {
    return std::hypot(a.x, a.y);
}

/// Minimises |a + s (b - a) - c - t (d - c)| over the unit square: the stationary point, else the four sides.
LaneGraphReference::Nearest LaneGraphReference::nearest_points(const Vector& a, const Vector& b,
                                                               const Vector& c, const Vector& d) {
    const Vector u = b - a;
    const Vector v = d - c;
    const Vector way = c - a;
    // Relative to `a`: far from the origin, the coordinates of the nearest points would be rounded by more
    // than a tie.
    const auto at = [&](Real s, Real t) {
        return Nearest{length({way.x + t * v.x - s * u.x, way.y + t * v.y - s * u.y}), s, t};
    };
    const auto foot = [](const Vector& p, const Vector& from, const Vector& direction) {
        const Real squared = dot(direction, direction);
        return squared > 0 ? std::clamp(dot(p - from, direction) / squared, Real{0}, Real{1}) : Real{0};
    };
    std::array<Nearest, 5> candidates{at(0, foot(a, c, v)), at(1, foot(b, c, v)), at(foot(c, a, u), 0),
                                      at(foot(d, a, u), 1), at(0, 0)};
    const Real determinant = wedge(u, v);
    if (determinant != 0) {
        const Real s = wedge(c - a, v) / determinant;
        const Real t = wedge(c - a, u) / determinant;
        if (s >= 0 && s <= 1 && t >= 0 && t <= 1) candidates[4] = {0, s, t};
    }
    return *std::ranges::min_element(candidates, {}, &Nearest::distance);
}

LaneGraphReference::Vector LaneGraphReference::position(std::size_t cone) const {
    return {scene_.cones[cone].position.x(), scene_.cones[cone].position.y()};
}

bool LaneGraphReference::is_near(std::size_t cone) const {
    const Vector way = position(cone) - car_;
    const bool aside = p_.d_side > 0 && std::abs(wedge(heading_, way)) > real(p_.d_side) + kTie;
    return !aside && length(way) <= real(p_.d_near) + kTie;
}

bool LaneGraphReference::are_apart(std::size_t a, std::size_t b) const {
    return length_of({a, b}) > real(p_.d_max) + kTie;
}

bool LaneGraphReference::has_length(const Edge& edge) const {
    return length_of(edge) >= kMinEdge_m;
}

Real LaneGraphReference::spacing_cost(const Edge& edge) const {
    return fourth((length_of(edge) - real(p_.d_e)) / real(p_.d_t));
}

bool LaneGraphReference::exceeds_s_crit(const Edge& edge) const {
    return spacing_cost(edge) > real(p_.s_crit) + kTie;
}

Real LaneGraphReference::interior_angle(std::size_t from, std::size_t middle, std::size_t to) const {
    const Vector back = position(from) - position(middle);
    const Vector on = position(to) - position(middle);
    return std::atan2(std::abs(wedge(back, on)), dot(back, on));
}

Real LaneGraphReference::angle_cost(std::size_t from, std::size_t middle, std::size_t to) const {
    return fourth((interior_angle(from, middle, to) - real(p_.theta_e)) / real(p_.theta_t));
}

bool LaneGraphReference::exceeds_t_crit(std::size_t from, std::size_t middle, std::size_t to) const {
    return angle_cost(from, middle, to) > real(p_.t_crit) + kTie;
}

bool LaneGraphReference::is_straight(std::size_t from, std::size_t middle, std::size_t to) const {
    const Real bend = std::numbers::pi_v<Real> - interior_angle(from, middle, to);
    return bend <= real(p_.theta_gap) + kTie;
}

/// Whether no cone stands on an edge over a gap: beside the part of it that d_clear at both ends leaves.
bool LaneGraphReference::is_clear(const Edge& edge) const {
    const Vector v = vector_of(edge);
    const Real apart = length(v);
    const Real margin = p_.d_clear;
    for (std::size_t cone = 0; cone < scene_.cones.size(); ++cone) {
        if (cone == edge.i || cone == edge.j) continue;
        const Vector from_i = position(cone) - position(edge.i);
        const Vector from_j = position(cone) - position(edge.j);
        if (std::abs(wedge(v, from_i)) < (margin - kTie) * apart &&
            dot(v, from_i) > (margin + kTie) * apart && -dot(v, from_j) > (margin + kTie) * apart)
            return false;
    }
    return true;
}

bool LaneGraphReference::is_over_gap(const Edge& edge) const {
    const Real apart = length_of(edge);
    if (apart > real(p_.d_gap) + kTie || apart <= real(p_.d_e)) return false;
    const auto goes_on = [&](std::size_t from, std::size_t to) {
        for (std::size_t on = 0; on < scene_.cones.size(); ++on) {
            if (on == from || on == to || !has_length({to, on})) continue;
            if (!exceeds_s_crit({to, on}) && is_straight(from, to, on)) return true;
        }
        return false;
    };
    return is_clear(edge) && (goes_on(edge.i, edge.j) || goes_on(edge.j, edge.i));
}

bool LaneGraphReference::joins_nearest(const Edge& edge) const {
    const double k = exceeds_s_crit(edge) ? p_.nearest_of_gap : p_.nearest_of_edge;
    if (k == 0.0) return true;
    const Real apart = length_of(edge);
    for (const std::size_t end : {edge.i, edge.j}) {
        std::size_t nearer = 0;
        for (std::size_t cone = 0; cone < scene_.cones.size(); ++cone)
            nearer += cone != end && length_of({end, cone}) < apart - kTie ? 1 : 0;
        if (static_cast<double>(nearer) < k) return true;
    }
    return false;
}

bool LaneGraphReference::is_along_heading(const Edge& edge) const {
    const Vector from = position(edge.i);
    const Vector v = vector_of(edge);
    const bool close = nearest_points(from, position(edge.j), car_, car_).distance <= real(p_.d_h) + kTie;
    const Real angle = std::atan2(std::abs(wedge(v, heading_)), std::abs(dot(v, heading_)));
    return close && angle <= real(p_.theta_heading) + kTie;
}

bool LaneGraphReference::are_too_close(const Edge& a, const Edge& b) const {
    const std::array<Vector, 4> at{position(a.i), position(a.j), position(b.i), position(b.j)};
    const Nearest nearest = nearest_points(at[0], at[1], at[2], at[3]);
    const Real ends = std::min(
        {length(at[0] - at[2]), length(at[0] - at[3]), length(at[1] - at[2]), length(at[1] - at[3])});
    return nearest.distance < real(p_.d_min) - kTie && ends > nearest.distance + kTie;
}

bool LaneGraphReference::cross(const Edge& a, const Edge& b) const {
    const auto on_both_sides = [&](const Edge& line, const Edge& ends) {
        const Vector v = vector_of(line);
        const Real one = wedge(v, position(ends.i) - position(line.i)) / length(v);
        const Real other = wedge(v, position(ends.j) - position(line.i)) / length(v);
        return std::min(one, other) < -kTie && std::max(one, other) > kTie;
    };
    return on_both_sides(a, b) && on_both_sides(b, a);
}

void LaneGraphReference::find_facing_edges() {
    for (std::size_t k = 0; k < scene_.cones.size(); ++k) {
        for (std::size_t l = k + 1; l < scene_.cones.size(); ++l) {
            if (!has_length({k, l}) || exceeds_s_crit({k, l})) continue;
            const Vector way = position(l) - position(k);
            const Real apart = length(way);
            facing_edges_.push_back({.k = k,
                                     .l = l,
                                     .length = apart,
                                     .middle = along(position(k), position(l), 0.5L),
                                     .direction = {way.x / apart, way.y / apart}});
        }
    }
}

/// The cost of the edge that faces this edge best; 1 if none does.
Real LaneGraphReference::facing_cost(const Edge& edge) const {
    const Vector along_edge = vector_of(edge);
    const Real own = length(along_edge);
    if (own == 0) return 1;
    const Vector middle = along(position(edge.i), position(edge.j), 0.5L);
    const auto squared = [](Real value) { return value * value; };
    Real best = 1;
    for (const FacingEdge& other : facing_edges_) {
        if (other.k == edge.i || other.k == edge.j || other.l == edge.i || other.l == edge.j) continue;
        const Vector way = other.middle - middle;
        const Real ahead = dot(way, along_edge) / own;
        const Real off_width = std::abs(wedge(along_edge, way)) / own - real(p_.lane_width_m);
        const Real turned = wedge(along_edge, other.direction) / (own * real(p_.facing_angle_rad));
        const Real longer = (other.length - own) / real(p_.facing_length_m);
        best = std::min(best, (squared(ahead) + squared(off_width)) / squared(p_.facing_distance_m) +
                                  squared(turned) + squared(longer));
    }
    return best;
}

/// Expected number of color faults: an edge joins a blue and a yellow cone, or an edge near the car is on the
/// wrong side for its color. The sum runs over the possible classes of both cones.
Real LaneGraphReference::color_faults(const Edge& edge) const {
    const std::array<ColorProbabilities, 2> colors{scene_.cones[edge.i].probabilities(),
                                                   scene_.cones[edge.j].probabilities()};
    const auto neither = [&](double ColorProbabilities::*color) {
        return (1 - real(colors[0].*color)) * (1 - real(colors[1].*color));
    };
    Real faults = 0;
    for (const std::size_t blue : {0, 1}) faults += real(colors[blue].blue) * real(colors[1 - blue].yellow);
    const Vector v = vector_of(edge);
    if (std::abs(dot(v, heading_)) <= kTie || !is_along_heading(edge)) return faults;
    const Real of_axis = wedge(heading_, along(position(edge.i), position(edge.j), 0.5L) - car_);
    const Real of_car = wedge(v, position(edge.i) - car_) * (dot(v, heading_) > 0 ? 1 : -1);
    if (of_axis < -kTie && of_car < -kTie) faults += 1 - neither(&ColorProbabilities::blue);
    if (of_axis > kTie && of_car > kTie) faults += 1 - neither(&ColorProbabilities::yellow);
    return faults;
}

Real LaneGraphReference::edge_cost(const Edge& edge) const {
    const Real across = std::abs(wedge(vector_of(edge), heading_));
    const Vector middle = along(position(edge.i), position(edge.j), 0.5L);
    const Real car_distance = std::max(length(middle - car_), 0.5L);
    Real benefit = p_.w_b;
    if (p_.use_confidence) {
        for (const std::size_t cone : {edge.i, edge.j}) benefit *= scene_.cones[cone].confidence;
    }
    Real cost = real(p_.w_s) * spacing_cost(edge) + real(p_.w_p) * fourth(across / car_distance) - benefit;
    if (p_.facing_weight > 0.0) cost += real(p_.facing_weight) * facing_cost(edge);
    if (p_.w_color == 0.0 && !learned_) return cost;
    const Real faults = color_faults(edge);
    cost += real(p_.w_color) * faults;
    if (learned_) cost += learned_->edge(std::min(edge.i, edge.j), std::max(edge.i, edge.j), faults);
    return cost;
}

Real LaneGraphReference::turn_cost(std::size_t from, std::size_t middle, std::size_t to) const {
    const Real uneven = (length_of({from, middle}) - length_of({middle, to})) / real(p_.d_t);
    const Real cost = real(p_.w_t) * angle_cost(from, middle, to);
    return cost + real(p_.unevenness_weight) * uneven * uneven +
           (learned_ ? learned_->turn(from, middle, to) : Real{0});
}

Real LaneGraphReference::end_cost(std::size_t cone) const {
    if (!is_near(cone)) return learned_ ? learned_->far_end(cone) : Real{0};
    const Real off = std::abs(wedge(heading_, position(cone) - car_)) - real(p_.lane_width_m) / 2;
    const Real off_scaled = off / real(p_.d_t);
    const Real benefit = real(p_.near_end_weight) * std::max(Real{0}, 1 - off_scaled * off_scaled);
    return (learned_ ? learned_->near_end(cone) : Real{0}) - benefit;
}

}  // namespace conelane
