#pragma once

#include "conelane/lane_graph.hpp"
#include "conelane/learned_costs.hpp"
#include "conelane/rld_parameters.hpp"

#include <map>
#include <numeric>
#include <utility>

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
            if (!(share > 0 && share < 1)) continue;  // NOLINT(misc-redundant-expression): NaN too
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
        Real best = best_facing(
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

/// The rules and costs of model/formulation.md in arithmetic of any precision, found cone by cone from the
/// scene. The checkers of lane graphs and of bounds use it. It shares no code with the builder of
/// LaneGraphProblem, so an error of the builder is not repeated here. Cone indices must be those of the
/// scene.
template <typename Real>
class LaneGraphReference {
  public:
    /// Both must outlive it.
    LaneGraphReference(const Scene& scene, const RldParameters& parameters)
        : scene_(scene), p_(parameters), heading_(direction(Real(scene.pose.yaw_rad))) {
        if (p_.facing_weight > 0.0) find_facing_edges();
        if (p_.learned_costs) learned_.emplace(scene_, p_);
    }

    /// (11)
    [[nodiscard]] bool is_near(std::size_t cone) const {
        const Vector way = from_car(cone);
        if (p_.d_side > 0.0 && size(wedge(heading_, way)) > Real(p_.d_side) + tie()) return false;
        return length(way) <= Real(p_.d_near) + tie();
    }
    /// (17): whether two cones are more than d_max from each other.
    [[nodiscard]] bool are_apart(std::size_t a, std::size_t b) const {
        return length_of({a, b}) > Real(p_.d_max) + tie();
    }
    /// In double, a shorter edge may lose its squares, and so its direction.
    [[nodiscard]] bool has_length(const Edge& edge) const { return length_of(edge) >= Real(1e-100L); }
    /// (27): then only a gap allows the edge.
    [[nodiscard]] bool exceeds_s_crit(const Edge& edge) const {
        return spacing_cost(edge) > Real(p_.s_crit) + tie();
    }
    [[nodiscard]] bool is_over_gap(const Edge& edge) const {
        const Real apart = length_of(edge);
        if (apart > Real(p_.d_gap) + tie() || apart <= Real(p_.d_e)) return false;
        const auto goes_on = [&](std::size_t from, std::size_t to) {
            for (std::size_t on = 0; on < scene_.cones.size(); ++on) {
                if (on == from || on == to || !has_length({to, on})) continue;
                if (!exceeds_s_crit({to, on}) && is_straight(from, to, on)) return true;
            }
            return false;
        };
        return is_clear(edge) && (goes_on(edge.i, edge.j) || goes_on(edge.j, edge.i));
    }
    /// Whether the edge joins a cone with one of its nearest, by the limit of edges of its kind.
    [[nodiscard]] bool joins_nearest(const Edge& edge) const {
        const double k = exceeds_s_crit(edge) ? p_.nearest_of_gap : p_.nearest_of_edge;
        if (k == 0.0) return true;
        const Real apart = length_of(edge);
        for (const std::size_t end : {edge.i, edge.j}) {
            std::size_t nearer = 0;
            for (std::size_t cone = 0; cone < scene_.cones.size(); ++cone)
                nearer += cone != end && length_of({end, cone}) < apart - tie() ? 1 : 0;
            if (static_cast<double>(nearer) < k) return true;
        }
        return false;
    }
    /// (9)
    [[nodiscard]] bool is_along_heading(const Edge& edge) const {
        using std::atan2;
        const Vector v = vector_of(edge);
        const Vector car{Real(scene_.pose.position.x()), Real(scene_.pose.position.y())};
        const bool close = distance(position(edge.i), v, car, {Real(0), Real(0)}) <= Real(p_.d_h) + tie();
        const Real angle = atan2(size(wedge(v, heading_)), size(dot(v, heading_)));
        return close && angle <= Real(p_.theta_heading) + tie();
    }
    /// (28): whether the way from one cone over another to a third one turns too sharply.
    [[nodiscard]] bool exceeds_t_crit(std::size_t from, std::size_t middle, std::size_t to) const {
        return angle_cost(from, middle, to) > Real(p_.t_crit) + tie();
    }
    /// Whether that way is as straight as an edge over a gap needs it.
    [[nodiscard]] bool is_straight(std::size_t from, std::size_t middle, std::size_t to) const {
        const Real bend = Real(std::numbers::pi_v<long double>) - interior_angle(from, middle, to);
        return bend <= Real(p_.theta_gap) + tie();
    }
    /// (6)-(8)
    [[nodiscard]] bool are_too_close(const Edge& a, const Edge& b) const {
        const Real nearest = distance(position(a.i), vector_of(a), position(b.i), vector_of(b));
        const Real ends = std::min(
            {length_of({a.i, b.i}), length_of({a.i, b.j}), length_of({a.j, b.i}), length_of({a.j, b.j})});
        return nearest < Real(p_.d_min) - tie() && ends > nearest + tie();
    }
    /// Whether the ends of each edge lie on different sides of the other's line, each farther than a tie.
    [[nodiscard]] bool cross(const Edge& a, const Edge& b) const {
        const auto on_both_sides = [&](const Edge& line, const Edge& ends) {
            const Vector v = vector_of(line);
            const Real one = wedge(v, vector_of({line.i, ends.i})) / length(v);
            const Real other = wedge(v, vector_of({line.i, ends.j})) / length(v);
            return std::min(one, other) < -tie() && std::max(one, other) > tie();
        };
        return on_both_sides(a, b) && on_both_sides(b, a);
    }

    /// (29), without the costs of turns and ends.
    [[nodiscard]] Real edge_cost(const Edge& edge) const {
        const Real across = size(wedge(vector_of(edge), heading_));
        const Real car_distance = std::max(length(middle_of(edge)), Real(0.5));
        Real benefit(p_.w_b);
        if (p_.use_confidence) {
            for (const std::size_t cone : {edge.i, edge.j}) benefit *= Real(scene_.cones[cone].confidence);
        }
        Real cost =
            Real(p_.w_s) * spacing_cost(edge) + Real(p_.w_p) * fourth(across / car_distance) - benefit;
        if (p_.facing_weight > 0.0) cost += Real(p_.facing_weight) * facing_cost(edge);
        if (p_.w_color == 0.0 && !learned_) return cost;
        const Real faults = color_faults(edge);
        cost += Real(p_.w_color) * faults;
        if (learned_) cost += learned_->edge(std::min(edge.i, edge.j), std::max(edge.i, edge.j), faults);
        return cost;
    }
    [[nodiscard]] Real turn_cost(std::size_t from, std::size_t middle, std::size_t to) const {
        const Real uneven = (length_of({from, middle}) - length_of({middle, to})) / Real(p_.d_t);
        Real cost = Real(p_.w_t) * angle_cost(from, middle, to);
        cost += Real(p_.unevenness_weight) * square(uneven);
        if (learned_) cost += learned_->turn(from, middle, to);
        return cost;
    }
    /// The cost of a path that ends at the cone.
    [[nodiscard]] Real end_cost(std::size_t cone) const {
        if (!is_near(cone)) return learned_ ? learned_->far_end(cone) : Real(0);
        const Real off = size(wedge(heading_, from_car(cone))) - Real(p_.lane_width_m) / 2;
        const Real benefit =
            Real(p_.near_end_weight) * std::max(Real(0), Real(1 - square(off / Real(p_.d_t))));
        return (learned_ ? learned_->near_end(cone) : Real(0)) - benefit;
    }

  private:
    struct Vector {
        Real x;
        Real y;
        Vector operator-(const Vector& b) const { return {x - b.x, y - b.y}; }
    };
    /// An edge that may be part of a boundary, so it may face another edge.
    struct FacingEdge {
        Edge cones;
        Vector vector;
        Real length;
        Vector middle;
    };

    static Real tie() { return Real(1e-9L); }
    static Real dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y; }
    static Real wedge(const Vector& a, const Vector& b) { return a.x * b.y - a.y * b.x; }
    /** Zero has no sign here: atan2 of -0 and a negative number would be -pi instead of pi. */
    static Real size(const Real& a) {
        if (a == 0) return Real(0);
        return a < 0 ? Real(-a) : a;
    }
    static Real square(const Real& a) { return a * a; }
    static Real fourth(const Real& a) { return square(square(a)); }
    static Real length(const Vector& a) {
        using std::sqrt;
        return sqrt(dot(a, a));
    }
    static Vector direction(const Real& angle_rad) {
        using std::cos;
        using std::sin;
        return {cos(angle_rad), sin(angle_rad)};
    }

    /// Minimises |a + s u - c - t v| over the unit square of s and t: the stationary point, else the sides.
    static Real distance(const Vector& a, const Vector& u, const Vector& c, const Vector& v) {
        const Vector way = c - a;
        // Relative to `a`: far from the origin, the coordinates of the nearest points would be rounded by
        // more than a tie.
        const auto at = [&](const Real& s, const Real& t) {
            return length({way.x + t * v.x - s * u.x, way.y + t * v.y - s * u.y});
        };
        const auto foot = [](const Vector& from, const Vector& along) {
            const Real squared = dot(along, along);
            return squared > 0 ? std::clamp(Real(dot(from, along) / squared), Real(0), Real(1)) : Real(0);
        };
        const Vector back{-way.x, -way.y};
        Real sides = std::min({at(Real(0), foot(back, v)), at(Real(1), foot(u - way, v)),
                               at(foot(way, u), Real(0)), at(foot({way.x + v.x, way.y + v.y}, u), Real(1))});
        const Real determinant = wedge(u, v);
        if (determinant == 0) return sides;
        const Real s = wedge(way, v) / determinant;
        const Real t = wedge(way, u) / determinant;
        return s >= 0 && s <= 1 && t >= 0 && t <= 1 ? Real(0) : sides;
    }

    [[nodiscard]] Vector position(std::size_t cone) const {
        return {Real(scene_.cones[cone].position.x()), Real(scene_.cones[cone].position.y())};
    }
    [[nodiscard]] Vector from_car(std::size_t cone) const {
        return position(cone) - Vector{Real(scene_.pose.position.x()), Real(scene_.pose.position.y())};
    }
    [[nodiscard]] Vector vector_of(const Edge& edge) const { return position(edge.j) - position(edge.i); }
    [[nodiscard]] Real length_of(const Edge& edge) const { return length(vector_of(edge)); }
    /// Seen from the car.
    [[nodiscard]] Vector middle_of(const Edge& edge) const {
        const Vector a = from_car(edge.i);
        const Vector b = from_car(edge.j);
        return {(a.x + b.x) / 2, (a.y + b.y) / 2};
    }
    [[nodiscard]] Real spacing_cost(const Edge& edge) const {
        return fourth((length_of(edge) - Real(p_.d_e)) / Real(p_.d_t));
    }
    [[nodiscard]] Real interior_angle(std::size_t from, std::size_t middle, std::size_t to) const {
        using std::atan2;
        const Vector back = vector_of({middle, from});
        const Vector on = vector_of({middle, to});
        return atan2(size(wedge(back, on)), dot(back, on));
    }
    [[nodiscard]] Real angle_cost(std::size_t from, std::size_t middle, std::size_t to) const {
        return fourth((interior_angle(from, middle, to) - Real(p_.theta_e)) / Real(p_.theta_t));
    }
    /// Whether no cone stands on an edge over a gap: beside the part of it that d_clear at both ends leaves.
    [[nodiscard]] bool is_clear(const Edge& edge) const {
        const Vector v = vector_of(edge);
        const Real apart = length(v);
        const Real margin(p_.d_clear);
        for (std::size_t cone = 0; cone < scene_.cones.size(); ++cone) {
            if (cone == edge.i || cone == edge.j) continue;
            const Vector from_i = vector_of({edge.i, cone});
            const Vector to_j = vector_of({cone, edge.j});
            if (size(wedge(v, from_i)) < (margin - tie()) * apart &&
                std::min(dot(v, from_i), dot(v, to_j)) > (margin + tie()) * apart)
                return false;
        }
        return true;
    }
    /// All edges that (27) allows: an edge that does not join nearest cones still faces others.
    void find_facing_edges() {
        for (std::size_t i = 0; i < scene_.cones.size(); ++i) {
            for (std::size_t j = i + 1; j < scene_.cones.size(); ++j) {
                const Edge edge{i, j};
                if (!has_length(edge) || exceeds_s_crit(edge)) continue;
                facing_edges_.push_back({edge, vector_of(edge), length_of(edge), middle_of(edge)});
            }
        }
    }
    /// The cost of the edge that faces this edge best; 1 if none does.
    [[nodiscard]] Real facing_cost(const Edge& edge) const {
        const Vector own = vector_of(edge);
        const Real own_length = length(own);
        Real best(1);
        if (own_length == 0) return best;
        const Vector middle = middle_of(edge);
        for (const FacingEdge& other : facing_edges_) {
            const auto& [k, l] = other.cones;
            if (k == edge.i || k == edge.j || l == edge.i || l == edge.j) continue;
            const Vector way = other.middle - middle;
            const Real ahead = dot(way, own) / own_length;
            const Real off_width = size(wedge(own, way)) / own_length - Real(p_.lane_width_m);
            const Real turned =
                wedge(own, other.vector) / (own_length * other.length * Real(p_.facing_angle_rad));
            const Real longer = (other.length - own_length) / Real(p_.facing_length_m);
            best =
                std::min(best, Real((square(ahead) + square(off_width)) / square(Real(p_.facing_distance_m)) +
                                    square(turned) + square(longer)));
        }
        return best;
    }
    /// Expected number of color faults: an edge joins a blue and a yellow cone, or an edge near the car is on
    /// the wrong side for its color. The sum runs over the possible classes of both cones.
    [[nodiscard]] Real color_faults(const Edge& edge) const {
        const std::array<ColorProbabilities, 2> colors{scene_.cones[edge.i].probabilities(),
                                                       scene_.cones[edge.j].probabilities()};
        const auto either = [&](double ColorProbabilities::*color) {
            return Real(1 - (1 - Real(colors[0].*color)) * (1 - Real(colors[1].*color)));
        };
        Real faults(0);
        for (const std::size_t blue : {0, 1})
            faults += Real(colors[blue].blue) * Real(colors[1 - blue].yellow);
        const Vector v = vector_of(edge);
        const Real ahead = dot(v, heading_);
        if (size(ahead) <= tie() || !is_along_heading(edge)) return faults;
        const Real of_axis = wedge(heading_, middle_of(edge));
        const Real of_car = ahead > 0 ? wedge(v, from_car(edge.i)) : Real(-wedge(v, from_car(edge.i)));
        if (of_axis < -tie() && of_car < -tie()) faults += either(&ColorProbabilities::blue);
        if (of_axis > tie() && of_car > tie()) faults += either(&ColorProbabilities::yellow);
        return faults;
    }

    const Scene& scene_;
    const RldParameters& p_;
    Vector heading_;
    std::vector<FacingEdge> facing_edges_;  ///< only if facing has a cost
    std::optional<LearnedReference<Real>> learned_;
};

}  // namespace conelane
