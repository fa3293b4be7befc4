#include "conelane/check.hpp"

#include "model/learned_reference.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

namespace conelane {
namespace {

// Independent arithmetic in extended precision, so that an error of the builders is not repeated here.
using Real = long double;
constexpr Real kTie = 1e-9L;
constexpr double kAgreement = 1e-6;
/// In double, a shorter edge may lose its squares, and so its direction.
constexpr Real kMinEdge = 1e-100L;

struct Vector {
    Real x;
    Real y;
};
Vector operator-(const Vector& a, const Vector& b) {
    return {a.x - b.x, a.y - b.y};
}
Vector along(const Vector& a, const Vector& b, Real t) {
    return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
}
Real dot(const Vector& a, const Vector& b) {
    return a.x * b.x + a.y * b.y;
}
Real wedge(const Vector& a, const Vector& b) {
    return a.x * b.y - a.y * b.x;
}
Real length(const Vector& a) {
    return std::hypot(a.x, a.y);
}

struct Nearest {
    Real distance;
    Real s;  ///< position on the first segment, in [0, 1]
    Real t;  ///< position on the second segment, in [0, 1]
};

/// Minimises |a + s (b - a) - c - t (d - c)| over the unit square: the stationary point, else the four sides.
Nearest nearest_points(const Vector& a, const Vector& b, const Vector& c, const Vector& d) {
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

/// Whether the ends of each segment lie on different sides of the other's line, each farther than a tie.
bool cross(const Vector& a, const Vector& b, const Vector& c, const Vector& d) {
    const auto off = [](const Vector& point, const Vector& from, const Vector& along) {
        return wedge(along, point - from) / length(along);
    };
    const auto apart = [](Real one, Real other) {
        return std::min(one, other) < -kTie && std::max(one, other) > kTie;
    };
    return apart(off(c, a, b - a), off(d, a, b - a)) && apart(off(a, c, d - c), off(b, c, d - c));
}

Real fourth(Real value) {
    return value * value * value * value;
}

class Checker {
  public:
    Checker(const Scene& scene, const RldParameters& parameters, const LaneGraph& graph)
        : scene_(scene),
          p_(parameters),
          graph_(graph),
          car_{scene.pose.position.x(), scene.pose.position.y()},
          heading_{std::cos(static_cast<Real>(scene.pose.yaw_rad)),
                   std::sin(static_cast<Real>(scene.pose.yaw_rad))} {}

    CheckReport run() {
        if (!edges_are_simple()) return std::move(report_);
        degrees_and_endpoints();
        paths_and_pairing();
        widths();
        costs();
        return std::move(report_);
    }

  private:
    [[nodiscard]] Vector position(std::size_t cone) const {
        return {scene_.cones[cone].position.x(), scene_.cones[cone].position.y()};
    }
    [[nodiscard]] std::string name(std::size_t cone) const { return std::to_string(scene_.cones[cone].id); }
    [[nodiscard]] std::string name(const Edge& edge) const {
        return "{" + name(edge.i) + ", " + name(edge.j) + "}";
    }
    [[nodiscard]] bool is_near(std::size_t cone) const {
        const Vector way = position(cone) - car_;
        const bool aside =
            p_.d_side > 0 && std::abs(wedge(heading_, way)) > static_cast<Real>(p_.d_side) + kTie;
        return !aside && length(way) <= static_cast<Real>(p_.d_near) + kTie;
    }
    /// For a violation that more edges may repair.
    void violated(std::string what) { report_.violations.push_back(std::move(what)); }
    void violated_for_good(std::string what) {
        violated(std::move(what));
        report_.is_final = true;
    }

    bool edges_are_simple() {
        std::set<std::pair<std::size_t, std::size_t>> seen;
        for (const Edge& edge : graph_.edges) {
            if (edge.i >= scene_.cones.size() || edge.j >= scene_.cones.size()) {
                violated_for_good("an edge ends at a cone that the scene does not have");
                return false;
            }
            if (edge.i == edge.j) violated_for_good("edge " + name(edge) + " is a loop");
            if (!seen.emplace(std::min(edge.i, edge.j), std::max(edge.i, edge.j)).second) {
                violated_for_good("edge " + name(edge) + " is there twice");
            }
            neighbours_[edge.i].push_back(edge.j);
            neighbours_[edge.j].push_back(edge.i);
        }
        return report_.violations.empty();
    }

    void degrees_and_endpoints() {
        std::vector<std::size_t> near_ends, far_ends;
        for (const auto& [cone, others] : neighbours_) {
            if (others.size() > 2)
                violated_for_good("(2) cone " + name(cone) + " has degree " + std::to_string(others.size()));
            if (others.size() == 1) (is_near(cone) ? near_ends : far_ends).push_back(cone);
        }
        const std::size_t ends = near_ends.size() + far_ends.size();
        if (ends != 4) violated("(3) " + std::to_string(ends) + " endpoints instead of 4");
        if (near_ends.size() != 2)
            violated("(11) " + std::to_string(near_ends.size()) + " near endpoints instead of 2");
        for (std::size_t a = 0; a < far_ends.size(); ++a) {
            for (std::size_t b = a + 1; b < far_ends.size(); ++b) {
                if (length(position(far_ends[a]) - position(far_ends[b])) >
                    static_cast<Real>(p_.d_max) + kTie) {
                    violated("(17) far endpoints " + name(far_ends[a]) + " and " + name(far_ends[b]) +
                             " are more than d_max apart");
                }
            }
        }
    }

    /// Connected components; a component with as many edges as cones holds a cycle.
    void paths_and_pairing() {
        std::set<std::size_t> visited;
        for (const auto& [start, unused] : neighbours_) {
            if (visited.contains(start)) continue;
            std::vector<std::size_t> open{start}, component;
            visited.insert(start);
            while (!open.empty()) {
                const std::size_t cone = open.back();
                open.pop_back();
                component.push_back(cone);
                for (const std::size_t next : neighbours_[cone]) {
                    if (visited.insert(next).second) open.push_back(next);
                }
            }
            std::size_t degrees = 0;
            std::size_t near_ends = 0;
            for (const std::size_t cone : component) {
                degrees += neighbours_[cone].size();
                if (neighbours_[cone].size() == 1 && is_near(cone)) ++near_ends;
            }
            if (degrees / 2 >= component.size()) violated_for_good("(5) a cycle through cone " + name(start));
            if (p_.pairing == Pairing::near_far && near_ends == 2) {
                violated("pairing: the path through cone " + name(start) + " joins both near endpoints");
            }
        }
    }

    void widths() {
        for (std::size_t e = 0; e < graph_.edges.size(); ++e) {
            for (std::size_t f = e + 1; f < graph_.edges.size(); ++f) {
                const Edge& a = graph_.edges[e];
                const Edge& b = graph_.edges[f];
                if (a.i == b.i || a.i == b.j || a.j == b.i || a.j == b.j) continue;
                const std::array<Vector, 4> at{position(a.i), position(a.j), position(b.i), position(b.j)};
                const Nearest nearest = nearest_points(at[0], at[1], at[2], at[3]);
                const Real ends = std::min({length(at[0] - at[2]), length(at[0] - at[3]),
                                            length(at[1] - at[2]), length(at[1] - at[3])});
                if (nearest.distance < static_cast<Real>(p_.d_min) - kTie && ends > nearest.distance + kTie) {
                    violated_for_good("(6) edges " + name(a) + " and " + name(b) + " are closer than d_min");
                }
                if (p_.forbid_crossing && cross(at[0], at[1], at[2], at[3])) {
                    violated_for_good("crossing: edges " + name(a) + " and " + name(b) + " cross");
                }
            }
        }
    }

    [[nodiscard]] Real benefit(const Edge& edge) const {
        Real weight = p_.w_b;
        if (p_.use_confidence) {
            for (const std::size_t cone : {edge.i, edge.j}) weight *= scene_.cones[cone].confidence;
        }
        return weight;
    }

    /// Expected number of color faults: an edge joins a blue and a yellow cone, or an edge near the car is
    /// on the wrong side for its color. The sum runs over the possible classes of both cones.
    [[nodiscard]] Real color_faults(const Edge& edge, bool along_the_heading) const {
        const std::array<ColorProbabilities, 2> colors{scene_.cones[edge.i].probabilities(),
                                                       scene_.cones[edge.j].probabilities()};
        const auto neither = [&](double ColorProbabilities::*color) {
            return (1 - static_cast<Real>(colors[0].*color)) * (1 - static_cast<Real>(colors[1].*color));
        };
        Real faults = 0;
        for (const std::size_t blue : {0, 1})
            faults += static_cast<Real>(colors[blue].blue) * static_cast<Real>(colors[1 - blue].yellow);
        const Vector v = position(edge.j) - position(edge.i);
        if (!along_the_heading || std::abs(dot(v, heading_)) <= kTie) return faults;
        const Real of_axis = wedge(heading_, along(position(edge.i), position(edge.j), 0.5L) - car_);
        const Real of_car = wedge(v, position(edge.i) - car_) * (dot(v, heading_) > 0 ? 1 : -1);
        if (of_axis < -kTie && of_car < -kTie) faults += 1 - neither(&ColorProbabilities::blue);
        if (of_axis > kTie && of_car > kTie) faults += 1 - neither(&ColorProbabilities::yellow);
        return faults;
    }

    [[nodiscard]] Real spacing(std::size_t a, std::size_t b) const {
        return fourth((length(position(b) - position(a)) - static_cast<Real>(p_.d_e)) /
                      static_cast<Real>(p_.d_t));
    }
    /// Angle by which the way from one cone through another to a third one differs from straight on.
    [[nodiscard]] Real bend(std::size_t from, std::size_t by, std::size_t to) const {
        const Vector back = position(from) - position(by);
        const Vector on = position(to) - position(by);
        return std::numbers::pi_v<Real> - std::atan2(std::abs(wedge(back, on)), dot(back, on));
    }
    [[nodiscard]] bool is_straight(std::size_t from, std::size_t by, std::size_t to) const {
        return bend(from, by, to) <= static_cast<Real>(p_.theta_gap) + kTie;
    }
    /// Whether an edge that exceeds s_crit is allowed over a gap.
    [[nodiscard]] bool is_gap(const Edge& edge) const {
        const Real apart = length(position(edge.j) - position(edge.i));
        if (apart > static_cast<Real>(p_.d_gap) + kTie || apart <= static_cast<Real>(p_.d_e)) return false;
        const auto goes_on = [&](std::size_t from, std::size_t to) {
            for (std::size_t on = 0; on < scene_.cones.size(); ++on) {
                if (on == from || on == to || length(position(on) - position(to)) < kMinEdge) continue;
                if (spacing(to, on) <= static_cast<Real>(p_.s_crit) + kTie && is_straight(from, to, on))
                    return true;
            }
            return false;
        };
        return is_clear(edge) && (goes_on(edge.i, edge.j) || goes_on(edge.j, edge.i));
    }
    /// Whether no cone stands on an edge over a gap: beside the part of it that d_clear at both ends leaves.
    [[nodiscard]] bool is_clear(const Edge& edge) const {
        const Vector v = position(edge.j) - position(edge.i);
        const Real apart = length(v);
        const auto margin = static_cast<Real>(p_.d_clear);
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

    /// Whether fewer than k cones are nearer to one end than the other end is; k of 0 is no limit.
    [[nodiscard]] bool is_among_nearest(const Edge& edge, double k) const {
        if (k == 0.0) return true;
        const Real apart = length(position(edge.j) - position(edge.i));
        for (const std::size_t end : {edge.i, edge.j}) {
            std::size_t nearer = 0;
            for (std::size_t cone = 0; cone < scene_.cones.size(); ++cone)
                nearer += cone != end && length(position(cone) - position(end)) < apart - kTie ? 1 : 0;
            if (static_cast<double>(nearer) < k) return true;
        }
        return false;
    }

    /// An edge that may be part of a boundary, so it may face another edge.
    struct FacingEdge {
        std::size_t k;
        std::size_t l;
        Real length;
        Vector middle;
        Vector direction;  ///< unit length
    };

    /// All edges that (27) allows; the same list serves every edge.
    [[nodiscard]] std::vector<FacingEdge> facing_edges() const {
        std::vector<FacingEdge> edges;
        for (std::size_t k = 0; k < scene_.cones.size(); ++k) {
            for (std::size_t l = k + 1; l < scene_.cones.size(); ++l) {
                const Vector way = position(l) - position(k);
                const Real apart = length(way);
                const Real spacing = fourth((apart - static_cast<Real>(p_.d_e)) / static_cast<Real>(p_.d_t));
                if (apart < kMinEdge || spacing > static_cast<Real>(p_.s_crit) + kTie) continue;
                edges.push_back(
                    {k, l, apart, along(position(k), position(l), 0.5L), {way.x / apart, way.y / apart}});
            }
        }
        return edges;
    }

    /// Cost of the edge in `others` that faces this edge best; 1 if none does.
    [[nodiscard]] Real facing_cost(const Edge& edge, const std::vector<FacingEdge>& others) const {
        const Vector along_edge = position(edge.j) - position(edge.i);
        const Real own = length(along_edge);
        if (own == 0) return 1;
        const Vector middle = along(position(edge.i), position(edge.j), 0.5L);
        Real best = 1;
        for (const FacingEdge& other : others) {
            if (other.k == edge.i || other.k == edge.j || other.l == edge.i || other.l == edge.j) continue;
            const Vector way = other.middle - middle;
            const Real ahead = dot(way, along_edge) / own;
            const Real off_width = std::abs(wedge(along_edge, way)) / own - static_cast<Real>(p_.d_w);
            const Real turned = wedge(along_edge, other.direction) / (own * static_cast<Real>(p_.theta_v));
            const Real longer = (other.length - own) / static_cast<Real>(p_.d_l);
            best = std::min(best,
                            (ahead * ahead + off_width * off_width) / (static_cast<Real>(p_.d_v) * p_.d_v) +
                                turned * turned + longer * longer);
        }
        return best;
    }

    /// The benefit z of a near endpoint at this cone, with its weight.
    [[nodiscard]] Real near_end_benefit(std::size_t cone) const {
        const Real off = std::abs(wedge(heading_, position(cone) - car_)) - static_cast<Real>(p_.d_w) / 2;
        const Real off_scaled = off / static_cast<Real>(p_.d_t);
        return static_cast<Real>(p_.w_n) * std::max(Real{0}, 1 - off_scaled * off_scaled);
    }

    void costs() {
        Real sum = 0;
        const std::vector<FacingEdge> facing = p_.w_v > 0 ? facing_edges() : std::vector<FacingEdge>{};
        std::optional<LearnedReference<Real>> learned;
        if (p_.learned_costs) learned.emplace(scene_, p_);
        std::set<std::pair<std::size_t, std::size_t>> gaps;
        for (const Edge& edge : graph_.edges) {
            const Vector from = position(edge.i);
            const Vector to = position(edge.j);
            const Vector v = to - from;
            const Real spacing = fourth((length(v) - static_cast<Real>(p_.d_e)) / static_cast<Real>(p_.d_t));
            if (spacing > static_cast<Real>(p_.s_crit) + kTie) {
                if (!is_gap(edge)) violated_for_good("(27) edge " + name(edge) + " exceeds s_crit");
                gaps.emplace(std::min(edge.i, edge.j), std::max(edge.i, edge.j));
            }
            if (length(v) < kMinEdge) violated_for_good("edge " + name(edge) + " has no length");
            const bool over_gap = gaps.contains({edge.i, edge.j});
            if (!is_among_nearest(edge, over_gap ? p_.k_gap : p_.k_edge))
                violated_for_good("nearest: at both cones of edge " + name(edge) + ", too many are nearer");
            const Real across = std::abs(wedge(v, heading_));
            const Real car_distance = std::max(length(along(from, to, 0.5L) - car_), 0.5L);
            sum += static_cast<Real>(p_.w_s) * spacing +
                   static_cast<Real>(p_.w_p) * fourth(across / car_distance) - benefit(edge);
            const bool close =
                nearest_points(from, to, car_, car_).distance <= static_cast<Real>(p_.d_h) + kTie;
            const Real angle = std::atan2(across, std::abs(dot(v, heading_)));
            const bool along_the_heading = close && angle <= static_cast<Real>(p_.theta_heading) + kTie;
            if (along_the_heading) ++report_.along_heading;
            const Real faults = color_faults(edge, along_the_heading);
            sum += static_cast<Real>(p_.w_color) * faults;
            if (learned) sum += learned->edge(std::min(edge.i, edge.j), std::max(edge.i, edge.j), faults);
            if (p_.w_v > 0) sum += static_cast<Real>(p_.w_v) * facing_cost(edge, facing);
        }
        if (report_.along_heading < 2)
            violated("(9) " + std::to_string(report_.along_heading) +
                     " edges along the heading instead of 2");
        for (const auto& [cone, others] : neighbours_) {
            if (others.size() == 1 && is_near(cone)) sum -= near_end_benefit(cone);
            if (others.size() == 1 && learned)
                sum += is_near(cone) ? learned->near_end(cone) : learned->far_end(cone);
            const auto over_gap = [&, at = cone](std::size_t other) {
                return gaps.contains({std::min(at, other), std::max(at, other)});
            };
            for (std::size_t a = 0; a < others.size(); ++a) {
                for (std::size_t b = a + 1; b < others.size(); ++b) {
                    const Vector to_a = position(others[a]) - position(cone);
                    const Vector to_b = position(others[b]) - position(cone);
                    const Real angle = std::atan2(std::abs(wedge(to_a, to_b)), dot(to_a, to_b));
                    const Real cost =
                        fourth((angle - static_cast<Real>(p_.theta_e)) / static_cast<Real>(p_.theta_t));
                    if (cost > static_cast<Real>(p_.t_crit) + kTie)
                        violated_for_good("(28) the angle at cone " + name(cone) + " exceeds t_crit");
                    if ((over_gap(others[a]) || over_gap(others[b])) &&
                        !is_straight(others[a], cone, others[b])) {
                        violated_for_good("gap: the angle at cone " + name(cone) + " exceeds theta_gap");
                    }
                    if (learned) sum += learned->turn(others[a], cone, others[b]);
                    const Real uneven = (length(to_a) - length(to_b)) / static_cast<Real>(p_.d_t);
                    sum += static_cast<Real>(p_.w_t) * cost + static_cast<Real>(p_.w_u) * uneven * uneven;
                }
            }
        }
        report_.objective = static_cast<double>(sum);
    }

    const Scene& scene_;
    const RldParameters& p_;
    const LaneGraph& graph_;
    Vector car_;
    Vector heading_;
    std::map<std::size_t, std::vector<std::size_t>> neighbours_;
    CheckReport report_;
};

}  // namespace

CheckReport check(const Scene& scene, const RldParameters& parameters, const LaneGraph& graph) {
    return Checker(scene, parameters, graph).run();
}

CheckReport check(const Scene& scene, const RldParameters& parameters, const LaneGraph& graph,
                  const Claim& claim) {
    CheckReport report = check(scene, parameters, graph);
    if (!report.objective) return report;
    const double tolerance = kAgreement * std::max(1.0, std::abs(*report.objective));
    if (!(std::abs(claim.objective - *report.objective) <= tolerance)) {
        report.violations.push_back("objective " + std::to_string(claim.objective) + " is claimed, " +
                                    std::to_string(*report.objective) + " is right");
    }
    if (claim.bound && !(*claim.bound <= *report.objective + tolerance)) {
        report.violations.emplace_back("the bound is above the objective");
    }
    if (claim.optimal &&
        !(claim.bound && *report.objective - *claim.bound <= claim.absolute_gap + tolerance)) {
        report.violations.emplace_back("optimal is claimed without a bound within the gap");
    }
    return report;
}

}  // namespace conelane
