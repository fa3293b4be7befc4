#pragma once

#include "conelane/learned_costs.hpp"
#include "conelane/rld_parameters.hpp"
#include "conelane/scene.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

namespace conelane {

/// The learned costs of formulation.md in arithmetic of any precision, computed cone by cone from the scene.
/// For checkers: it shares no code with LearnedFeatures, which builds the problem's costs.
template <typename Real>
class LearnedReference {
  public:
    /// Both must outlive it. Precondition: the parameters have learned costs.
    LearnedReference(const Scene& scene, const RldParameters& parameters) : p_(parameters) {
        using std::cos;
        using std::sin;
        const Real yaw(scene.pose.yaw_rad);
        ahead_ = {cos(yaw), sin(yaw)};
        for (const Cone& cone : scene.cones) {
            cones_.push_back(&cone);
            place_.push_back({Real(cone.position.x()) - Real(scene.pose.position.x()),
                              Real(cone.position.y()) - Real(scene.pose.position.y())});
            const Real away = length(place_.back());
            view_ = std::max(view_,
                             Real(away * unit((70 - away) / 10) * unit(1 + dot(ahead_, place_.back()) / 10)));
        }
        find_facing();
    }

    /// `color_cost`: that of ProblemEdge, from the caller.
    [[nodiscard]] Real edge(std::size_t i, std::size_t j, Real color_cost) const {
        const Vector along = place_[j] - place_[i];
        const Real far = length(along);
        const Vector middle = half(place_[i] + place_[j]);
        const Real car = length(middle);
        Real beside(0), crowd(0), left(0), right(0);
        for (std::size_t k = 0; k < place_.size(); ++k) {
            if (k == i || k == j) continue;
            crowd += fall(length(place_[k] - middle) / Real(3.5));
            const Real share = dot(place_[k] - place_[i], along) / (far * far);
            if (!(share > 0 && share < 1)) continue;
            const Real off = wedge(along, place_[k] - place_[i]) / far;
            const Real inner = share * (1 - share);
            beside += 4 * inner * fall(off / Real(1.2));
            const Real in = unit(8 * inner) * unit((size(off) - Real(0.6)) / Real(0.4)) *
                            unit((Real(2.6) - size(off)) / Real(0.4));
            (off > 0 ? left : right) += in;
        }
        const Real across = size(wedge(along, ahead_)) / std::max(car, Real(0.5));
        const Cone& a = *cones_[i];
        const Cone& b = *cones_[j];
        const bool blue = a.color == ConeColor::blue && b.color == ConeColor::blue;
        const bool yellow = a.color == ConeColor::yellow && b.color == ConeColor::yellow;
        return value(
            LearnedPart::edge,
            {Real(1), least(spacing(far), 7), least(across * across * across * across, 4), facing(i, j),
             facing_any(i, j), beyond(far) / 3, least(size(far - Real(p_.d_e)) / Real(p_.d_t), 4),
             least(beside, 2), least(crowd, 6) / 2, least(std::min(left, right), 2), least(car / 30, 2),
             size(wedge(ahead_, middle)) / (car + 1), color_cost, Real(blue || yellow ? 1 : 0),
             1 - Real(a.confidence) * Real(b.confidence)});
    }

    [[nodiscard]] Real turn(std::size_t i, std::size_t middle, std::size_t k) const {
        using std::atan2;
        const Vector to_i = place_[i] - place_[middle];
        const Vector to_k = place_[k] - place_[middle];
        const Real m = length(to_i);
        const Real n = length(to_k);
        const Real area = wedge(to_i, to_k);
        const Real chord = length(place_[k] - place_[i]);
        Real inside(0);
        for (std::size_t c = 0; c < place_.size(); ++c) {
            if (c == i || c == k || c == middle || area == 0) continue;
            const Vector way = place_[c] - place_[middle];
            if (dot(way, way) > std::max(m * m, n * n)) continue;  // outside the triangle
            // Depth below each side of the triangle, from the area of the triangle of that side and the cone.
            const auto depth = [&](std::size_t from, std::size_t to) {
                const Real made = wedge(place_[to] - place_[from], place_[c] - place_[from]);
                return (area > 0 ? made : -made) / length(place_[to] - place_[from]);
            };
            inside += unit(std::min(depth(middle, i), std::min(depth(i, k), depth(k, middle))) / Real(0.4));
        }
        const Real angle = size(atan2(size(area), dot(to_i, to_k)) - Real(p_.theta_e)) / Real(p_.theta_t);
        const Real uneven = (m - n) / Real(p_.d_t);
        const Real one = facing(std::min(i, middle), std::max(i, middle));
        const Real other = facing(std::min(k, middle), std::max(k, middle));
        const Real cost = value(
            LearnedPart::turn,
            {Real(1), least(angle * angle * angle * angle, 4), least(uneven * uneven, 4), least(angle, 4),
             least(angle * angle, 4), least(inside, 2), least((m + n) / 8, 3), (beyond(m) + beyond(n)) / 3,
             least(angle * (beyond(m) + beyond(n)) / 3, 4), (one + other) / 2, size(one - other),
             crowd_at(middle), least(length(place_[middle]) / 30, 2),
             least(10 * size(area) / (m * n * std::max(chord, Real(0.1))), 3)});
        return std::max(cost, Real(0));
    }

    [[nodiscard]] Real near_end(std::size_t cone) const {
        const Real ahead = dot(ahead_, place_[cone]);
        const Real off = size(size(wedge(ahead_, place_[cone])) - Real(p_.lane_width_m) / 2) / Real(p_.d_t);
        Real behind(0);
        for (std::size_t k = 0; k < place_.size(); ++k) {
            if (k == cone) continue;
            behind += fall(length(place_[k] - place_[cone]) / 6) * unit((ahead - dot(ahead_, place_[k])) / 2);
        }
        const Real cost = value(LearnedPart::near_end,
                                {Real(1), fall(off), least(off, 3), std::max(Real(-1), least(ahead / 6, 2)),
                                 least(length(place_[cone]) / 6, 2), least(behind, 3), crowd_at(cone)});
        return std::min(cost, Real(0));
    }

    [[nodiscard]] Real far_end(std::size_t cone) const {
        const Real away = length(place_[cone]);
        Real on(0);
        for (std::size_t k = 0; k < place_.size(); ++k) {
            if (k != cone)
                on += fall(length(place_[k] - place_[cone]) / 6) * unit((length(place_[k]) - away) / 2);
        }
        const Real cost = value(LearnedPart::far_end,
                                {Real(1), least(away / 30, 2), unit((view_ - away) / 10), least(on, 3),
                                 crowd_at(cone), size(wedge(ahead_, place_[cone])) / (away + 1)});
        return std::min(cost, Real(0));
    }

  private:
    struct Vector {
        Real x;
        Real y;
        Vector operator-(const Vector& o) const { return {x - o.x, y - o.y}; }
        Vector operator+(const Vector& o) const { return {x + o.x, y + o.y}; }
    };
    struct Facing {
        std::size_t k;
        std::size_t l;
        Real length;
        Real middle_x;
    };

    /// Pairs of cones within s_crit, by the x of their middle. A sweep along x, because all pairs of hundreds
    /// of cones would take longer than the time between two checks of the clock.
    void find_facing() {
        const double longest_m = p_.d_e + p_.d_t * std::pow(p_.s_crit + 1e-9, 0.25) + 1e-6;
        std::vector<std::size_t> by_x(place_.size());
        std::iota(by_x.begin(), by_x.end(), std::size_t{0});
        std::ranges::sort(by_x, [&](std::size_t i, std::size_t j) { return place_[i].x < place_[j].x; });
        for (std::size_t a = 0; a < by_x.size(); ++a) {
            for (std::size_t b = a + 1; b < by_x.size(); ++b) {
                const auto [i, j] = std::minmax(by_x[a], by_x[b]);
                if (place_[by_x[b]].x - place_[by_x[a]].x > Real(longest_m)) break;
                const Real apart = length(place_[j] - place_[i]);
                if (apart < Real(1e-100) || spacing(apart) > Real(p_.s_crit) + Real(1e-9)) continue;
                facing_.push_back({i, j, apart, half(place_[i] + place_[j]).x});
            }
        }
        std::ranges::sort(facing_, [](const Facing& a, const Facing& b) { return a.middle_x < b.middle_x; });
    }

    static Real dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y; }
    static Real wedge(const Vector& a, const Vector& b) { return a.x * b.y - a.y * b.x; }
    static Real length(const Vector& a) {
        using std::sqrt;
        return sqrt(dot(a, a));
    }
    static Vector half(const Vector& a) { return {a.x / 2, a.y / 2}; }
    /// Absolute value; 0 for -0, because atan2 distinguishes the two.
    static Real size(const Real& a) { return a > 0 ? a : a < 0 ? Real(-a) : Real(0); }
    static Real least(const Real& a, int most) { return std::min(a, Real(most)); }
    static Real unit(const Real& a) { return std::max(Real(0), std::min(a, Real(1))); }
    static Real fall(const Real& a) { return std::max(Real(0), Real(1 - a * a)); }
    static Real beyond(const Real& length) { return std::max(Real(0), Real(length - 5)); }
    [[nodiscard]] Real spacing(const Real& apart) const {
        const Real off = (apart - Real(p_.d_e)) / Real(p_.d_t);
        return off * off * off * off;
    }
    [[nodiscard]] Real crowd_at(std::size_t cone) const {
        Real sum(0);
        for (std::size_t k = 0; k < place_.size(); ++k) {
            if (k != cone) sum += fall(length(place_[k] - place_[cone]) / Real(3.5));
        }
        return least(sum, 6) / 2;
    }

    /// The smallest value of `measure` (along, across, sine, longer) over the edges that may face {i, j}, at
    /// most 1. `reach_m`: `measure` is at least 1 if the middles are farther apart.
    template <typename Measure>
    [[nodiscard]] Real best_facing(std::size_t i, std::size_t j, double reach_m,
                                   const Measure& measure) const {
        const Vector own = place_[j] - place_[i];
        const Real own_length = length(own);
        const Real middle_x = half(place_[i] + place_[j]).x;
        Real best(1);
        const auto first =
            std::ranges::lower_bound(facing_, Real(middle_x - Real(reach_m)), {}, &Facing::middle_x);
        for (auto other = first; other != facing_.end() && other->middle_x <= middle_x + Real(reach_m);
             ++other) {
            if (other->k == i || other->k == j || other->l == i || other->l == j) continue;
            const Vector way = half(place_[other->k] + place_[other->l] - place_[i] - place_[j]);
            const Real sine = wedge(own, place_[other->l] - place_[other->k]) / (own_length * other->length);
            best = std::min(best, Real(measure(dot(way, own) / own_length, size(wedge(own, way)) / own_length,
                                               sine, other->length - own_length)));
        }
        return best;
    }
    [[nodiscard]] Real facing(std::size_t i, std::size_t j) const {
        const auto known = known_facing_.find({i, j});
        if (known != known_facing_.end()) return known->second;
        const Real d_v(p_.facing_distance_m), theta_v(p_.facing_angle_rad), d_w(p_.lane_width_m),
            d_l(p_.facing_length_m);
        const double reach_m = p_.lane_width_m + 2.0 * p_.facing_distance_m + 1e-6;
        const Real best = best_facing(
            i, j, reach_m, [&](const Real& l, const Real& b, const Real& sine, const Real& longer) {
                return Real((l * l + (b - d_w) * (b - d_w)) / (d_v * d_v) +
                            sine * sine / (theta_v * theta_v) + longer * longer / (d_l * d_l));
            });
        known_facing_.emplace(std::pair(i, j), best);
        return best;
    }
    [[nodiscard]] Real facing_any(std::size_t i, std::size_t j) const {
        constexpr double kReach_m = 8.0;  // more than 4 m along and 6.5 m across
        return best_facing(i, j, kReach_m, [&](const Real& l, const Real& b, const Real& sine, const Real&) {
            const Real off = std::max(Real(0), Real(b - Real(5.5))) + std::max(Real(0), Real(Real(2.5) - b));
            return Real(l * l / 16 + off * off + sine * sine / Real(0.6) / Real(0.6));
        });
    }

    [[nodiscard]] Real value(LearnedPart part, const std::vector<Real>& features) const {
        const LearnedNetwork& network = p_.learned_costs->of(part);
        Real sum(0);
        for (std::size_t u = 0; u < network.units(); ++u) {
            Real unit_sum(0);
            for (std::size_t i = 0; i < features.size(); ++i)
                unit_sum += Real(network.hidden[i * network.units() + u]) * features[i];
            if (unit_sum > 0) sum += Real(network.output[u]) * unit_sum;
        }
        for (std::size_t i = 0; i < features.size(); ++i) sum += Real(network.linear[i]) * features[i];
        return sum;
    }

    const RldParameters& p_;
    Vector ahead_{};
    std::vector<const Cone*> cones_;
    std::vector<Vector> place_;  ///< relative to the car
    Real view_{0};
    std::vector<Facing> facing_;  ///< edges within s_crit, by middle_x
    mutable std::map<std::pair<std::size_t, std::size_t>, Real> known_facing_;
};

}  // namespace conelane
