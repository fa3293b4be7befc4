#pragma once

#include "conelane/lane_graph.hpp"
#include "conelane/rld_parameters.hpp"
#include "conelane/scene.hpp"
#include "model/learned_reference.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <vector>

namespace conelane {

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
        const Real sides =
            std::min({at(Real(0), foot(back, v)), at(Real(1), foot(u - way, v)), at(foot(way, u), Real(0)),
                      at(foot({way.x + v.x, way.y + v.y}, u), Real(1))});
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
