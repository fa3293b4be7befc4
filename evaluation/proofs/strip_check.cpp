#include "evaluation/proofs/strip_check.hpp"

#include "evaluation/world/annotated_scene.hpp"
#include "model/lane_graph_reference.hpp"

#include <set>

namespace conelane {
namespace {

using Real = long double;
constexpr Real kTie = 1e-9L;
constexpr double kAgreement = 1e-6;
constexpr Real kNone = std::numeric_limits<Real>::infinity();

struct Place {
    Real x, y;
};
Place operator-(Place a, Place b) {
    return {a.x - b.x, a.y - b.y};
}
Place between(Place a, Place b) {
    return {(a.x + b.x) / 2, (a.y + b.y) / 2};
}
Real size(Place a) {
    return std::hypot(a.x, a.y);
}
Real dot(Place a, Place b) {
    return a.x * b.x + a.y * b.y;
}
/// Twice the signed area of a triangle, positive if it turns to the left.
Real doubled_area(Place a, Place b, Place c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}
Real unit(Real value) {
    return std::min<Real>(1, std::max<Real>(0, value));
}
/// 1 - (distance / reach)^2, at least 0.
Real fall(Real distance, Real reach) {
    return std::max<Real>(0, 1 - (distance / reach) * (distance / reach));
}
Real least(Real value, Real most) {
    return std::min(value, most);
}
Real beyond(Real length) {
    return std::max<Real>(0, length - 5) / 3;
}

/// The limits of formulation.md and the learned costs, cone by cone.
class StripReference {
  public:
    StripReference(const Scene& scene, const StripParameters& p) : p_(p), graph_(scene, p.gates) {
        const Real yaw = scene.pose.yaw_rad;
        ahead_ = {std::cos(yaw), std::sin(yaw)};
        for (const Cone& cone : scene.cones) {
            at_.push_back({Real(cone.position.x()) - Real(scene.pose.position.x()),
                           Real(cone.position.y()) - Real(scene.pose.position.y())});
            const Real away = size(at_.back());
            view_ = std::max(view_, away * unit((70 - away) / 10) * unit(1 + dot(ahead_, at_.back()) / 10));
        }
    }

    [[nodiscard]] const LaneGraphReference<Real>& graph() const { return graph_; }
    [[nodiscard]] Real width(std::size_t a, std::size_t b) const { return size(at_[a] - at_[b]); }
    [[nodiscard]] bool is_rung(std::size_t l, std::size_t r) const {
        return width(l, r) >= Real(p_.w_min_m) - kTie && width(l, r) <= Real(p_.w_max_m) + kTie &&
               (width(l, r) <= Real(p_.w_usual_m) + kTie || has_few_nearer(l, r) || has_few_nearer(r, l));
    }
    /// Whether `across` is among the nearest cones of `end`.
    [[nodiscard]] bool has_few_nearer(std::size_t end, std::size_t across) const {
        std::size_t nearer = 0;
        for (std::size_t cone = 0; cone < at_.size(); ++cone)
            nearer += cone != end && width(end, cone) < width(end, across) - kTie ? 1 : 0;
        return p_.nearest_of_rung == 0.0 || static_cast<double>(nearer) < p_.nearest_of_rung;
    }
    [[nodiscard]] bool may_start(std::size_t l, std::size_t r) const {
        return is_rung(l, r) && graph_.is_near(l) && graph_.is_near(r) && left(l) > left(r);
    }
    [[nodiscard]] bool may_end(std::size_t cone) const {
        return p_.d_end_m == 0.0 || size(at_[cone]) > Real(p_.d_end_m) + kTie;
    }
    /// Positive if the cone is to the left of the edge.
    [[nodiscard]] Real side(std::size_t from, std::size_t to, std::size_t cone) const {
        return doubled_area(at_[from], at_[to], at_[cone]);
    }

    [[nodiscard]] Real edge(std::size_t i, std::size_t j) const {
        if (!p_.costs) return graph_.edge_cost(make_edge(i, j));
        const Real far = width(i, j);
        const Place middle = between(at_[i], at_[j]);
        Real close(0), wide(0), crowd(0), on_left(0), on_right(0);
        for (std::size_t k = 0; k < at_.size(); ++k) {
            if (k == i || k == j) continue;
            crowd += fall(size(at_[k] - middle), 3.5L);
            const Real share = dot(at_[k] - at_[i], at_[j] - at_[i]) / (far * far);
            if (share <= 0 || share >= 1) continue;
            const Real off = side(i, j, k) / far;
            const Real hump = 4 * share * (1 - share);
            close += hump * fall(off, 1.2L);
            wide += hump * fall(off, 2.5L);
            (off > 0 ? on_left : on_right) +=
                unit(2 * hump) * unit((std::abs(off) - 0.6L) / 0.4L) * unit((2.6L - std::abs(off)) / 0.4L);
        }
        crowd = least(crowd, 6) / 2;
        const Real stretch = (far - 4) / 2;
        return value(StripPart::edge,
                     {1, far / 5, beyond(far), least(stretch * stretch, 4), std::max<Real>(0, 2 - far),
                      least(close, 2), crowd, beyond(far) * least(wide, 3), beyond(far) * crowd,
                      far / 5 * crowd, least(std::min(on_left, on_right), 2), least(size(middle) / 30, 2)});
    }

    [[nodiscard]] Real triangle(std::size_t from, std::size_t to, std::size_t across) const {
        if (!p_.costs) return 0;
        const Real step = width(from, to);
        const Real before = width(from, across);
        const Real after = width(to, across);
        const Real off = std::abs(after - 3.7L);
        const Real change = std::abs(after - before);
        const Real lead = dot(at_[across] - at_[from], at_[to] - at_[from]) / (4 * step);
        const Real later = lead - step / 4;
        const Real area = std::abs(side(from, to, across)) / 2;
        const Real cosine = (before * before + after * after - step * step) / (2 * before * after);
        const Real rotation = std::atan2(2 * area, cosine * before * after);
        return value(StripPart::triangle,
                     {1, inside(from, to, across), std::max<Real>(0, after - 4.5L),
                      std::max<Real>(0, 3.2L - after), off, least(off * off, 4), lead, lead * lead, later,
                      later * later, change, least(change * change, 9), least(area / 10, 3), rotation,
                      rotation * rotation, std::max<Real>(0, -lead) * std::max<Real>(0, -later)});
    }

    [[nodiscard]] Real start(std::size_t l, std::size_t r) const {
        if (!p_.costs) return 0;
        const Real off = std::abs(width(l, r) - 3.7L);
        const Real aside = std::abs(left(l) + left(r)) / 2;
        const Real forward = (ahead(l) + ahead(r)) / 2;
        const Real skew = std::abs(ahead(l) - ahead(r)) / 4;
        Real between_car(0), behind(0);
        for (std::size_t k = 0; k < at_.size(); ++k) {
            if (k == l || k == r) continue;
            between_car += unit(depth(at_[k], {0, 0}, at_[l], at_[r]) / 0.4L);
            for (const std::size_t end : {l, r})
                behind += fall(width(k, end), 6) * unit((ahead(end) - ahead(k)) / 2);
        }
        return value(StripPart::start,
                     {1, least(aside, 6), least(aside * aside, 9), std::max<Real>(-1, least(forward / 6, 2)),
                      std::max<Real>(0, least(-forward / 2, 2)), least(forward * forward / 36, 4), skew,
                      least(skew * skew, 4), off, least(off * off, 4), least(between_car, 2),
                      least(behind, 4), crowd(between(at_[l], at_[r]), l, r)});
    }

    [[nodiscard]] Real turn(std::size_t i, std::size_t j, std::size_t k, bool is_left) const {
        if (!p_.costs) return graph_.turn_cost(i, j, k);
        const Real back = width(i, j);
        const Real on = width(j, k);
        const Real area = std::abs(side(i, j, k));
        const Real angle = std::acos(-1.0L) - std::atan2(area, dot(at_[i] - at_[j], at_[k] - at_[j]));
        const Real sharp = std::max<Real>(0, angle - 0.8L);
        const Real uneven = (back - on) / 2;
        const bool lane_inside = is_left ? side(i, j, k) < 0 : side(i, j, k) > 0;
        return value(StripPart::turn,
                     {1, angle, angle * angle, sharp,
                      least(10 * area / (back * on * std::max<Real>(width(i, k), 0.1L)), 3), inside(i, j, k),
                      least(uneven * uneven, 4), least((back + on) / 8, 3), lane_inside ? angle : 0,
                      angle * (beyond(back) + beyond(on)), crowd(at_[j], j, j)});
    }

    [[nodiscard]] Real begin(std::size_t cone) const { return p_.costs ? 0 : graph_.end_cost(cone); }
    [[nodiscard]] Real end(std::size_t from, std::size_t to) const {
        if (!p_.costs) return graph_.end_cost(to);
        const Place step = at_[to] - at_[from];
        const Real reach = std::min<Real>(5, std::max<Real>(3, size(step))) / size(step);
        const Place next{at_[to].x + step.x * reach, at_[to].y + step.y * reach};
        Real on(0);
        for (std::size_t k = 0; k < at_.size(); ++k)
            if (k != from && k != to) on += fall(size(at_[k] - next), 2.5L);
        const Real away = size(at_[to]);
        const Real in_view = unit((view_ - size(next)) / 5);
        return value(StripPart::end,
                     {1, unit((view_ - away) / 10), least(on, 2), in_view, least(on, 2) * in_view,
                      least(away / 30, 2), std::abs(left(to)) / (away + 1), crowd(at_[to], to, to)});
    }

  private:
    [[nodiscard]] Real ahead(std::size_t cone) const { return dot(ahead_, at_[cone]); }
    [[nodiscard]] Real left(std::size_t cone) const {
        return ahead_.x * at_[cone].y - ahead_.y * at_[cone].x;
    }
    /// Below the nearest side of the triangle.
    static Real depth(Place p, Place a, Place b, Place c) {
        const Real sign = doubled_area(a, b, c) > 0 ? 1 : -1;
        const auto below = [&](Place s, Place t) {
            return sign * doubled_area(s, t, p) / std::max<Real>(size(t - s), 0.1L);
        };
        return std::min({below(a, b), below(b, c), below(c, a)});
    }
    [[nodiscard]] Real inside(std::size_t a, std::size_t b, std::size_t c) const {
        Real sum(0);
        for (std::size_t k = 0; k < at_.size(); ++k)
            if (k != a && k != b && k != c) sum += unit(depth(at_[k], at_[a], at_[b], at_[c]) / 0.4L);
        return least(sum, 2);
    }
    [[nodiscard]] Real crowd(Place place, std::size_t without, std::size_t and_without) const {
        Real sum(0);
        for (std::size_t k = 0; k < at_.size(); ++k)
            if (k != without && k != and_without) sum += fall(size(at_[k] - place), 3.5L);
        return least(sum, 6) / 2;
    }
    [[nodiscard]] Real value(StripPart part, const std::vector<Real>& x) const {
        const LearnedNetwork& network = p_.costs->of(part);
        Real sum = std::inner_product(x.begin(), x.end(), network.linear.begin(), Real(0));
        for (std::size_t u = 0; u < network.units(); ++u) {
            Real unit_sum(0);
            for (std::size_t k = 0; k < x.size(); ++k)
                unit_sum += network.hidden[k * network.units() + u] * x[k];
            sum += network.output[u] * std::max<Real>(0, unit_sum);
        }
        return sum;
    }

    const StripParameters& p_;
    LaneGraphReference<Real> graph_;
    Place ahead_{};
    std::vector<Place> at_;
    Real view_ = 0;
};

/// What limits of edges and turns a boundary breaks, and its cost without triangles.
Real boundary_cost(const StripReference& reference, const std::vector<std::size_t>& side, bool is_left,
                   std::vector<std::string>& violations) {
    const LaneGraphReference<Real>& graph = reference.graph();
    Real cost = 0;
    for (std::size_t k = 1; k < side.size(); ++k) {
        const Edge edge = make_edge(side[k - 1], side[k]);
        if ((graph.exceeds_s_crit(edge) && !graph.is_over_gap(edge)) || !graph.joins_nearest(edge) ||
            !graph.has_length(edge))
            violations.emplace_back("(27) an edge is not allowed");
        cost += reference.edge(edge.i, edge.j);
        if (k + 1 == side.size()) continue;
        const Edge next = make_edge(side[k], side[k + 1]);
        const bool over_gap = graph.exceeds_s_crit(edge) || graph.exceeds_s_crit(next);
        if (graph.exceeds_t_crit(side[k - 1], side[k], side[k + 1]) ||
            (over_gap && !graph.is_straight(side[k - 1], side[k], side[k + 1])))
            violations.emplace_back("(28) a turn is not allowed");
        cost += reference.turn(side[k - 1], side[k], side[k + 1], is_left);
    }
    return cost + reference.begin(side.front()) + reference.end(side[side.size() - 2], side.back());
}

/// The cheapest triangles between the boundaries: least[i][j] reaches the rung of left i and right j.
Real cheapest_triangles(const StripReference& reference, const std::vector<std::size_t>& left,
                        const std::vector<std::size_t>& right) {
    std::vector<std::vector<Real>> least(left.size(), std::vector<Real>(right.size(), kNone));
    for (std::size_t i = 0; i < left.size(); ++i) {
        for (std::size_t j = 0; j < right.size(); ++j) {
            if (!reference.is_rung(left[i], right[j])) continue;
            if (i == 0 && j == 0) least[0][0] = reference.start(left[0], right[0]);
            if (i > 0 && reference.side(left[i - 1], left[i], right[j]) < 0)
                least[i][j] = std::min(least[i][j],
                                       least[i - 1][j] + reference.triangle(left[i - 1], left[i], right[j]));
            if (j > 0 && reference.side(right[j - 1], right[j], left[i]) > 0)
                least[i][j] = std::min(least[i][j],
                                       least[i][j - 1] + reference.triangle(right[j - 1], right[j], left[i]));
        }
    }
    return least.back().back();
}

}  // namespace

CheckReport check_strip(const Scene& scene, const StripParameters& parameters, const Lane& lane,
                        const std::optional<Claim>& claim) {
    CheckReport report;
    const auto fail = [&](const char* what) {
        report.violations.emplace_back(what);
        return report;
    };
    const auto index_of = index_by_id(scene);
    std::vector<std::size_t> left, right;
    std::set<std::size_t> cones;
    for (const auto& [ids, side] : {std::pair(&lane.left, &left), std::pair(&lane.right, &right)}) {
        for (const ConeId id : *ids) {
            const auto found = index_of.find(id);
            if (found == index_of.end()) return fail("a cone is not in the scene");
            if (!cones.insert(found->second).second) return fail("a cone is used twice");
            side->push_back(found->second);
        }
        if (side->size() < 2) return fail("a boundary has no edge");
    }
    const StripReference reference(scene, parameters);
    if (!reference.may_start(left.front(), right.front()))
        return fail("the lane does not begin near the car");
    if (!reference.may_end(left.back()) || !reference.may_end(right.back()))
        return fail("the lane ends near the car");
    const Real cost = boundary_cost(reference, left, true, report.violations) +
                      boundary_cost(reference, right, false, report.violations) +
                      cheapest_triangles(reference, left, right);
    if (!(cost < kNone)) return fail("no strip joins the boundaries");
    report.objective = static_cast<double>(cost);
    if (!claim) return report;
    const double tolerance = kAgreement * std::max(1.0, std::abs(*report.objective));
    if (!(std::abs(claim->objective - *report.objective) <= tolerance)) fail("the objective is another one");
    if (claim->bound && !(*claim->bound <= *report.objective + tolerance))
        fail("the bound is above the objective");
    if (claim->optimal &&
        !(claim->bound && *report.objective - *claim->bound <= claim->absolute_gap + tolerance))
        fail("optimal is claimed without a bound within the gap");
    return report;
}

}  // namespace conelane
