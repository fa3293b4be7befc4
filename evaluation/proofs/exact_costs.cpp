#include "evaluation/proofs/exact_costs.hpp"

#include "conelane/check.hpp"
#include "model/learned_reference.hpp"

#include <algorithm>
#include <cmath>

#include <boost/multiprecision/cpp_bin_float.hpp>

namespace conelane {
namespace {

using Real = boost::multiprecision::cpp_bin_float_50;

/// Pairs of edges whose distance exceeds d_min by more than this are not tested.
constexpr double kSlack_m = 1e-3;

Real square(const Real& value) {
    return value * value;
}
Real fourth(const Real& value) {
    return square(square(value));
}

/// One unit below the rounded-down value: the error of 50 digits is far smaller.
Exact rounded_down(const Real& value) {
    return Exact(boost::multiprecision::floor(ldexp(value, kExactFractionBits))) - 1;
}

class Builder {
  public:
    Builder(const Scene& scene, const RldParameters& parameters)
        : scene_(scene),
          p_(parameters),
          cos_(cos(Real(scene.pose.yaw_rad))),
          sin_(sin(Real(scene.pose.yaw_rad))) {
        without_costs_ = parameters;
        without_costs_.w_v = 0.0;
        without_costs_.w_color = 0.0;
        without_costs_.learned_costs.reset();
        if (p_.learned_costs) learned_.emplace(scene_, p_);
        if (p_.w_color == 0.0 && !learned_) return;
        for (const ConeColor color : {ConeColor::blue, ConeColor::yellow}) {
            Scene& painted = color == ConeColor::blue ? all_blue_ : all_yellow_;
            painted = scene;
            for (Cone& cone : painted.cones) {
                cone.color = color;
                cone.color_probabilities.reset();
            }
        }
    }

    ExactScene run() {
        find_edges();
        find_excluded();
        find_successions();
        find_ends();
        return std::move(result_);
    }

  private:
    struct Vector {
        Real x;
        Real y;
        [[nodiscard]] Real length() const { return sqrt(x * x + y * y); }
    };
    static Real wedge(const Vector& a, const Vector& b) { return a.x * b.y - a.y * b.x; }
    static Real dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y; }

    [[nodiscard]] Vector from_to(std::size_t from, std::size_t to) const {
        const Point& a = scene_.cones[from].position;
        const Point& b = scene_.cones[to].position;
        return {Real(b.x()) - Real(a.x()), Real(b.y()) - Real(a.y())};
    }
    [[nodiscard]] Vector from_car(std::size_t cone) const {
        const Point& c = scene_.cones[cone].position;
        return {Real(c.x()) - Real(scene_.pose.position.x()), Real(c.y()) - Real(scene_.pose.position.y())};
    }
    struct MeasuredEdge {
        Edge cones;
        Vector vector;
        Real length;
        Vector middle;  ///< from the car
    };
    [[nodiscard]] MeasuredEdge measured(const Edge& edge) const {
        const Vector vector = from_to(edge.i, edge.j);
        const Vector a = from_car(edge.i);
        const Vector b = from_car(edge.j);
        return {edge, vector, vector.length(), {(a.x + b.x) / 2, (a.y + b.y) / 2}};
    }
    /// Across the car's heading.
    [[nodiscard]] Real across(const Vector& v) const { return abs(v.x * sin_ - v.y * cos_); }

    void find_edges() {
        for (std::size_t i = 0; i < scene_.cones.size(); ++i) {
            for (std::size_t j = i + 1; j < scene_.cones.size(); ++j) {
                const CheckReport report = check(scene_, without_costs_, {{{i, j}}});
                if (report.is_final) continue;
                result_.edges.push_back({i, j});
                result_.along_heading.push_back(report.along_heading > 0);
            }
        }
        for (const Edge& edge : result_.edges) measured_.push_back(measured(edge));
        if (p_.w_v > 0.0) find_facing_edges();
        for (std::size_t e = 0; e < result_.edges.size(); ++e)
            result_.edge_cost.push_back(rounded_down(edge_cost(e)));
    }

    /// All edges that (27) allows: an edge that does not join nearest cones still faces others.
    void find_facing_edges() {
        for (std::size_t i = 0; i < scene_.cones.size(); ++i) {
            for (std::size_t j = i + 1; j < scene_.cones.size(); ++j) {
                const MeasuredEdge edge = measured({i, j});
                const Real spacing = fourth((edge.length - Real(p_.d_e)) / Real(p_.d_t));
                if (edge.length >= Real("1e-100") && spacing <= Real(p_.s_crit) + Real("1e-9"))
                    facing_.push_back(edge);
            }
        }
    }

    /// (29) without the costs of turns and ends.
    [[nodiscard]] Real edge_cost(std::size_t e) const {
        const Edge& edge = result_.edges[e];
        const Real car_distance = std::max(measured_[e].middle.length(), Real(0.5));
        Real benefit = p_.w_b;
        if (p_.use_confidence) {
            benefit *= Real(scene_.cones[edge.i].confidence) * Real(scene_.cones[edge.j].confidence);
        }
        Real cost = Real(p_.w_s) * fourth((measured_[e].length - Real(p_.d_e)) / Real(p_.d_t)) +
                    Real(p_.w_p) * fourth(across(measured_[e].vector) / car_distance) - benefit;
        if (p_.w_v > 0.0) cost += Real(p_.w_v) * facing_cost(measured_[e]);
        const Real faults = p_.w_color > 0.0 || learned_ ? color_faults(edge) : Real(0);
        if (p_.w_color > 0.0) cost += Real(p_.w_color) * faults;
        if (learned_) cost += learned_->edge(edge.i, edge.j, faults);
        return cost;
    }

    /// v_ij of formulation.md.
    [[nodiscard]] Real facing_cost(const MeasuredEdge& edge) const {
        Real best = 1;
        for (const MeasuredEdge& other : facing_) {
            if (other.cones.i == edge.cones.i || other.cones.i == edge.cones.j ||
                other.cones.j == edge.cones.i || other.cones.j == edge.cones.j) {
                continue;
            }
            const Vector way{other.middle.x - edge.middle.x, other.middle.y - edge.middle.y};
            const Real ahead = dot(way, edge.vector) / edge.length;
            const Real off_width = abs(wedge(edge.vector, way)) / edge.length - Real(p_.d_w);
            const Real turned =
                wedge(edge.vector, other.vector) / (edge.length * other.length * Real(p_.theta_v));
            const Real longer = (other.length - edge.length) / Real(p_.d_l);
            best = std::min(best, Real((square(ahead) + square(off_width)) / square(Real(p_.d_v)) +
                                       square(turned) + square(longer)));
        }
        return best;
    }

    /// The checker decides on which side the edge is: if all cones have the color of one side, edges on the
    /// other side have a fault.
    [[nodiscard]] Real color_faults(const Edge& edge) const {
        RldParameters colors = p_;
        colors.w_s = colors.w_t = colors.w_p = colors.w_b = colors.w_u = colors.w_v = colors.w_n = 0.0;
        colors.w_color = 1.0;
        colors.learned_costs.reset();
        const auto is_fault_in = [&](const Scene& scene) {
            return std::lround(check(scene, colors, {{edge}}).objective.value()) == 1;
        };
        const ColorProbabilities a = scene_.cones[edge.i].probabilities();
        const ColorProbabilities b = scene_.cones[edge.j].probabilities();
        const auto either = [](double of_a, double of_b) {
            return Real(of_a) + Real(of_b) - Real(of_a) * Real(of_b);
        };
        Real faults = Real(a.blue) * Real(b.yellow) + Real(a.yellow) * Real(b.blue);
        if (is_fault_in(all_blue_)) faults += either(a.blue, b.blue);
        if (is_fault_in(all_yellow_)) faults += either(a.yellow, b.yellow);
        return faults;
    }

    [[nodiscard]] bool are_far_from_each_other(const Edge& a, const Edge& b) const {
        const auto position = [&](std::size_t cone) -> const Point& { return scene_.cones[cone].position; };
        const double apart =
            (0.5 * (position(a.i) + position(a.j)) - 0.5 * (position(b.i) + position(b.j))).norm();
        const double reach =
            0.5 * (position(a.i) - position(a.j)).norm() + 0.5 * (position(b.i) - position(b.j)).norm();
        return apart > reach + p_.d_min + kSlack_m;
    }

    void find_excluded() {
        const std::size_t count = result_.edges.size();
        result_.excluded.assign(count, boost::dynamic_bitset<>(count));
        for (std::size_t e = 0; e < count; ++e) {
            for (std::size_t f = e + 1; f < count; ++f) {
                if (are_far_from_each_other(result_.edges[e], result_.edges[f])) continue;
                if (!check(scene_, without_costs_, {{result_.edges[e], result_.edges[f]}}).is_final) continue;
                result_.excluded[e].set(f);
                result_.excluded[f].set(e);
            }
        }
    }

    void find_successions() {
        std::vector<std::vector<std::size_t>> leaving(scene_.cones.size());
        for (std::size_t a = 0; a < 2 * result_.edges.size(); ++a) leaving[result_.tail(a)].push_back(a);
        result_.successions.resize(2 * result_.edges.size());
        for (std::size_t a = 0; a < 2 * result_.edges.size(); ++a) {
            for (const std::size_t b : leaving[result_.head(a)]) {
                if (b / 2 == a / 2 || result_.excluded[a / 2][b / 2]) continue;
                // A turn costs the same in both directions.
                const std::size_t back = b ^ 1U;
                const auto known = back < a ? std::ranges::find(result_.successions[back], a ^ 1U,
                                                                &ExactScene::Succession::arc)
                                            : result_.successions[back].end();
                const bool is_known = back < a && known != result_.successions[back].end();
                result_.successions[a].push_back({b, is_known ? known->cost : rounded_down(turn_cost(a, b))});
            }
        }
    }

    [[nodiscard]] Real turn_cost(std::size_t a, std::size_t b) const {
        const Vector back = from_to(result_.head(a), result_.tail(a));
        const Vector on = from_to(result_.head(a), result_.head(b));
        const Real angle = atan2(abs(wedge(back, on)), dot(back, on));
        Real cost = Real(p_.w_t) * fourth((angle - Real(p_.theta_e)) / Real(p_.theta_t)) +
                    Real(p_.w_u) * square((measured_[a / 2].length - measured_[b / 2].length) / Real(p_.d_t));
        if (learned_) cost += learned_->turn(result_.tail(a), result_.head(a), result_.head(b));
        return cost;
    }

    void find_ends() {
        const std::size_t count = scene_.cones.size();
        // A value within 1e-9 of a limit is within it, as for the checker.
        const Real tie("1e-9");
        for (std::size_t cone = 0; cone < count; ++cone) {
            const Vector place = from_car(cone);
            const bool aside = p_.d_side > 0.0 && across(place) > Real(p_.d_side) + tie;
            result_.near.push_back(!aside && place.length() <= Real(p_.d_near) + tie);
            const Real off = (across(place) - Real(p_.d_w) / 2) / Real(p_.d_t);
            const Real fit = std::max(Real(0), Real(1 - square(off)));
            const bool is_near = result_.near.back();
            Real cost = is_near ? Real(-Real(p_.w_n) * fit) : Real(0);
            if (learned_) cost += is_near ? learned_->near_end(cone) : learned_->far_end(cone);
            result_.end_cost.push_back(is_near || learned_ ? rounded_down(cost) : Exact(0));
        }
        result_.partners.assign(count, std::vector<bool>(count, false));
        for (std::size_t f = 0; f < count; ++f) {
            for (std::size_t g = 0; g < count; ++g) {
                if (f == g || result_.near[f] || result_.near[g]) continue;
                result_.partners[f][g] = from_to(f, g).length() <= Real(p_.d_max) + tie;
            }
        }
    }

    const Scene& scene_;
    const RldParameters& p_;
    RldParameters without_costs_;
    Scene all_blue_;  ///< the scene with this color alone, if colors count
    Scene all_yellow_;
    std::optional<LearnedReference<Real>> learned_;
    Real cos_;
    Real sin_;
    std::vector<MeasuredEdge> measured_;  ///< by edge of the result
    std::vector<MeasuredEdge> facing_;    ///< those that can face others; only if w_v > 0
    ExactScene result_;
};

}  // namespace

Exact exact_below(double value) {
    return Exact(boost::multiprecision::floor(ldexp(Real(value), kExactFractionBits)));
}

std::optional<std::size_t> ExactScene::find(const Edge& edge) const {
    const auto found = std::ranges::lower_bound(edges, edge);
    if (found == edges.end() || *found != edge) return std::nullopt;
    return static_cast<std::size_t>(found - edges.begin());
}

Exact ExactScene::cost_limit() const {
    Exact sum = Exact(1) << kExactFractionBits;
    for (const Exact& cost : edge_cost) {
        if (cost > 0) sum += cost;
    }
    for (std::size_t a = 0; a < successions.size(); ++a) {
        for (const Succession& next : successions[a]) {
            if (a < (next.arc ^ 1U)) sum += next.cost;
        }
    }
    return sum;
}

ExactScene make_exact_scene(const Scene& scene, const RldParameters& parameters) {
    return Builder(scene, parameters).run();
}

}  // namespace conelane
