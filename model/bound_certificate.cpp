#include "conelane/bound_certificate.hpp"

#include "model/geometry.hpp"
#include "model/learned_reference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

namespace conelane {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();
constexpr double kAgreement = 1e-6;
constexpr double kMinEdge = 1e-100;  // [m], as in formulation.md
// A walk counts as shorter only if it is shorter by more than this.
constexpr double kShorter = 1e-12;

double square(double value) {
    return value * value;
}
double fourth(double value) {
    return square(square(value));
}

class Verification {
  public:
    Verification(const Scene& scene, const RldParameters& parameters, const BoundCertificate& certificate)
        : scene_(scene), p_(parameters), certificate_(certificate), heading_(scene.pose.heading()) {
        if (p_.learned_costs) learned_.emplace(scene_, p_);
    }

    BoundVerdict run() {
        if (p_.pairing != Pairing::near_far) violated("certificates are for the pairing near_far");
        check_multipliers();
        check_cliques();
        if (!verdict_.violations.empty()) return std::move(verdict_);
        build_arcs();
        if (!shortest_walks()) {
            violated("a walk gains from an endless cycle: the multipliers prove no bound");
            return std::move(verdict_);
        }
        const double bound = combine();
        verdict_.bound = bound;
        if (!(certificate_.bound <= bound + kAgreement)) {
            violated("the bound " + std::to_string(certificate_.bound) +
                     " is claimed, the multipliers prove " + std::to_string(bound));
        }
        return std::move(verdict_);
    }

  private:
    struct Arc {
        std::size_t from;
        std::size_t to;
        double cost;  ///< reduced, with the multiplier of the cone `to`
    };
    struct Succession {
        std::size_t arc;  ///< the next one
        double cost;      ///< of the turn
    };
    /// An edge that (27) or a gap allows. No walk uses one that does not join nearest cones, but such an edge
    /// still faces others.
    struct AllowedEdge {
        std::size_t i;
        std::size_t j;
        Point vector;
        double length;
        Point middle;
        bool over_gap;
    };

    void violated(std::string what) { verdict_.violations.push_back(std::move(what)); }
    [[nodiscard]] const Point& position(std::size_t cone) const { return scene_.cones[cone].position; }
    [[nodiscard]] bool near(std::size_t cone) const {
        const Point way = position(cone) - scene_.pose.position;
        if (p_.d_side > 0.0 && std::abs(cross(heading_, way)) > p_.d_side + kTieTolerance) return false;
        return way.norm() <= p_.d_near + kTieTolerance;
    }
    [[nodiscard]] double angle_cost(std::size_t i, std::size_t middle, std::size_t k) const {
        return fourth((interior_angle(position(i), position(middle), position(k)) - p_.theta_e) / p_.theta_t);
    }
    /// Whether the way by the cone goes on as straight as an edge over a gap needs it.
    [[nodiscard]] bool is_straight(std::size_t i, std::size_t middle, std::size_t k) const {
        const double angle = interior_angle(position(i), position(middle), position(k));
        return std::numbers::pi - angle <= p_.theta_gap + kTieTolerance;
    }
    [[nodiscard]] double length_of(const Edge& edge) const {
        return (position(edge.j) - position(edge.i)).norm();
    }
    /// Such an edge is allowed over a gap or not at all.
    [[nodiscard]] bool exceeds_s_crit(const Edge& edge) const {
        return spacing_cost(length_of(edge)) > p_.s_crit + kTieTolerance;
    }
    /// Whether (28) or a gap forbids the turn from one edge to another one that it shares the cone with.
    [[nodiscard]] bool is_forbidden_turn(std::size_t i, std::size_t middle, std::size_t k) const {
        if (angle_cost(i, middle, k) > p_.t_crit + kTieTolerance) return true;
        const bool over_gap = exceeds_s_crit({i, middle}) || exceeds_s_crit({middle, k});
        return over_gap && !is_straight(i, middle, k);
    }
    [[nodiscard]] double unevenness(std::size_t i, std::size_t middle, std::size_t k) const {
        const double before = (position(middle) - position(i)).norm();
        const double after = (position(k) - position(middle)).norm();
        return square((before - after) / p_.d_t);
    }
    /// Cost of a walk that begins at this near cone.
    [[nodiscard]] double near_end_cost(std::size_t cone) const {
        const double off_m = std::abs(cross(heading_, position(cone) - scene_.pose.position)) - 0.5 * p_.d_w;
        const double benefit = p_.w_n * std::max(0.0, 1.0 - square(off_m / p_.d_t));
        return (learned_ ? static_cast<double>(learned_->near_end(cone)) : 0.0) - benefit;
    }
    /// What a walk costs that ends at the far cone.
    [[nodiscard]] double far_end_cost(std::size_t cone) const {
        return learned_ ? static_cast<double>(learned_->far_end(cone)) : 0.0;
    }

    void check_multipliers() {
        if (certificate_.cone_multiplier.size() != scene_.cones.size())
            violated("the number of multipliers differs from the number of cones");
        const auto bad = [](double multiplier) { return !(multiplier >= 0.0 && std::isfinite(multiplier)); };
        if (std::ranges::any_of(certificate_.cone_multiplier, bad) || bad(certificate_.heading_multiplier) ||
            std::ranges::any_of(certificate_.cliques, bad, &BoundCertificate::Clique::multiplier)) {
            violated("a multiplier is negative or not finite");
        }
    }

    /// Whether (7), (28) or a gap forbids two edges together.
    [[nodiscard]] bool excluded(const Edge& a, const Edge& b) const {
        if (a == b) return false;
        for (const auto& [middle, i] : {std::pair{a.i, a.j}, std::pair{a.j, a.i}}) {
            for (const auto& [other, k] : {std::pair{b.i, b.j}, std::pair{b.j, b.i}}) {
                if (middle == other) return is_forbidden_turn(i, middle, k);
            }
        }
        const Segment first{position(a.i), position(a.j)};
        const Segment second{position(b.i), position(b.j)};
        if (p_.forbid_crossing && segments_cross(first, second)) return true;
        const SegmentDistance gap = segment_distance(first, second);
        return gap.distance_m < p_.d_min - kTieTolerance && !gap.between_ends;
    }

    void check_cliques() {
        for (const BoundCertificate::Clique& clique : certificate_.cliques) {
            for (std::size_t k = 0; k < clique.edges.size(); ++k) {
                const Edge& edge = clique.edges[k];
                if (edge.i >= edge.j || edge.j >= scene_.cones.size()) {
                    violated("a clique holds an invalid edge");
                    return;
                }
                for (std::size_t l = 0; l < k; ++l) {
                    if (!excluded(clique.edges[l], edge)) {
                        violated("a clique holds two edges that may go together");
                        return;
                    }
                }
            }
        }
    }

    [[nodiscard]] double spacing_cost(double length) const { return fourth((length - p_.d_e) / p_.d_t); }

    /// Whether no cone stands on an edge over a gap, see d_clear.
    [[nodiscard]] bool is_clear(const Edge& edge) const {
        const Point along = (position(edge.j) - position(edge.i)).normalized();
        for (std::size_t cone = 0; cone < scene_.cones.size(); ++cone) {
            if (cone == edge.i || cone == edge.j) continue;
            const Point from_i = position(cone) - position(edge.i);
            const double past_i = along.dot(from_i);
            const double before_j = along.dot(position(edge.j) - position(cone));
            if (std::abs(cross(along, from_i)) < p_.d_clear - kTieTolerance &&
                std::min(past_i, before_j) > p_.d_clear + kTieTolerance)
                return false;
        }
        return true;
    }

    /// Whether an edge that exceeds s_crit is allowed: no cone stands on it, and at one of its ends an edge
    /// within s_crit goes straight on.
    [[nodiscard]] bool is_over_gap(const Edge& edge) const {
        const double length = length_of(edge);
        if (length > p_.d_gap + kTieTolerance || length <= p_.d_e || !is_clear(edge)) return false;
        for (const auto& [from, to] : {std::pair{edge.i, edge.j}, std::pair{edge.j, edge.i}}) {
            for (std::size_t on = 0; on < scene_.cones.size(); ++on) {
                if (on == from || on == to || length_of({to, on}) < kMinEdge) continue;
                if (!exceeds_s_crit({to, on}) && is_straight(from, to, on)) return true;
            }
        }
        return false;
    }

    /// Whether one cone has the other one among its k nearest; k of 0 is no limit.
    [[nodiscard]] bool joins_nearest(const Edge& edge, double k) const {
        const auto nearer_to = [&](std::size_t end) {
            std::size_t count = 0;
            for (std::size_t cone = 0; cone < scene_.cones.size(); ++cone) {
                if (cone != end && length_of({end, cone}) < length_of(edge) - kTieTolerance) ++count;
            }
            return static_cast<double>(count);
        };
        return k == 0.0 || nearer_to(edge.i) < k || nearer_to(edge.j) < k;
    }

    [[nodiscard]] std::vector<AllowedEdge> allowed_edges() const {
        std::vector<AllowedEdge> edges;
        for (std::size_t i = 0; i < scene_.cones.size(); ++i) {
            for (std::size_t j = i + 1; j < scene_.cones.size(); ++j) {
                const bool is_long = exceeds_s_crit({i, j});
                const double length = length_of({i, j});
                if (length < kMinEdge || (is_long && !is_over_gap({i, j}))) continue;
                edges.push_back(
                    {i, j, position(j) - position(i), length, 0.5 * (position(i) + position(j)), is_long});
            }
        }
        return edges;
    }

    /// The faults of color that are expected of an edge: between a blue and a yellow cone, and near the car
    /// on the side that its color is not.
    [[nodiscard]] double color_faults(const AllowedEdge& edge, bool along_heading) const {
        const ColorProbabilities a = scene_.cones[edge.i].probabilities();
        const ColorProbabilities b = scene_.cones[edge.j].probabilities();
        double faults = a.blue * b.yellow + a.yellow * b.blue;
        const double ahead = edge.vector.dot(heading_);
        if (!along_heading || std::abs(ahead) <= kTieTolerance) return faults;
        const auto either = [](double of_a, double of_b) { return of_a + of_b - of_a * of_b; };
        // The edge as seen from the car, and the car as seen from the edge.
        const double left_m = cross(heading_, edge.middle - scene_.pose.position);
        const double turned =
            std::copysign(1.0, ahead) * cross(edge.vector, position(edge.i) - scene_.pose.position);
        if (std::max(left_m, turned) < -kTieTolerance) faults += either(a.blue, b.blue);
        if (std::min(left_m, turned) > kTieTolerance) faults += either(a.yellow, b.yellow);
        return faults;
    }

    /// v_ij of formulation.md: the cost of the edge that faces this one best.
    [[nodiscard]] double facing_cost(const AllowedEdge& edge, const std::vector<AllowedEdge>& all) const {
        double best = 1.0;
        for (const AllowedEdge& other : all) {
            if (other.over_gap) continue;
            if (other.i == edge.i || other.i == edge.j || other.j == edge.i || other.j == edge.j) continue;
            const Point way = other.middle - edge.middle;
            const double ahead_m = way.dot(edge.vector) / edge.length;
            const double off_width_m = std::abs(cross(edge.vector, way)) / edge.length - p_.d_w;
            const double turned = cross(edge.vector, other.vector) / (edge.length * other.length);
            best = std::min(best, (square(ahead_m) + square(off_width_m)) / square(p_.d_v) +
                                      square(turned / p_.theta_v) +
                                      square((other.length - edge.length) / p_.d_l));
        }
        return best;
    }

    void build_arcs() {
        std::map<Edge, double> clique_multiplier;
        for (const BoundCertificate::Clique& clique : certificate_.cliques) {
            for (const Edge& edge : clique.edges) clique_multiplier[edge] += clique.multiplier;
        }
        std::vector<std::vector<std::size_t>> leaving(scene_.cones.size());  // arcs by their first cone
        const std::vector<AllowedEdge> edges = allowed_edges();
        for (const AllowedEdge& edge : edges) {
            if (!joins_nearest({edge.i, edge.j}, edge.over_gap ? p_.k_gap : p_.k_edge)) continue;
            const double across = std::abs(cross(edge.vector, heading_));
            const double car_distance = std::max((edge.middle - scene_.pose.position).norm(), 0.5);
            const double confidence =
                p_.use_confidence ? scene_.cones[edge.i].confidence * scene_.cones[edge.j].confidence : 1.0;
            double cost = p_.w_s * spacing_cost(edge.length) + p_.w_p * fourth(across / car_distance) -
                          p_.w_b * confidence;
            if (p_.w_v > 0.0) cost += p_.w_v * facing_cost(edge, edges);
            const Segment segment{position(edge.i), position(edge.j)};
            const bool along_heading =
                foot_point(scene_.pose.position, segment).distance_m <= p_.d_h + kTieTolerance &&
                std::atan2(across, std::abs(edge.vector.dot(heading_))) <= p_.theta_heading + kTieTolerance;
            if (p_.w_color > 0.0 || learned_) {
                const double faults = color_faults(edge, along_heading);
                cost += p_.w_color * faults;
                if (learned_) cost += static_cast<double>(learned_->edge(edge.i, edge.j, faults));
            }
            if (along_heading) cost -= certificate_.heading_multiplier;
            const auto multiplier = clique_multiplier.find({edge.i, edge.j});
            if (multiplier != clique_multiplier.end()) cost += multiplier->second;
            for (const auto& [from, to] : {std::pair{edge.i, edge.j}, std::pair{edge.j, edge.i}}) {
                leaving[from].push_back(arcs_.size());
                arcs_.push_back({from, to, cost + certificate_.cone_multiplier[to]});
            }
        }
        find_successions(leaving);
    }

    void find_successions(const std::vector<std::vector<std::size_t>>& leaving) {
        successions_.resize(arcs_.size());
        for (std::size_t a = 0; a < arcs_.size(); ++a) {
            const auto& [from, middle, unused] = arcs_[a];
            for (const std::size_t b : leaving[middle]) {
                const std::size_t to = arcs_[b].to;
                if (to == from || is_forbidden_turn(from, middle, to)) continue;
                double cost = p_.w_t * angle_cost(from, middle, to) + p_.w_u * unevenness(from, middle, to);
                if (learned_) cost += static_cast<double>(learned_->turn(from, middle, to));
                successions_[a].push_back({b, cost});
            }
        }
    }

    /// Bellman-Ford rounds; false if a negative cycle keeps them from ending.
    bool shortest_walks() {
        walk_.assign(arcs_.size(), kNone);
        for (std::size_t a = 0; a < arcs_.size(); ++a) {
            const std::size_t from = arcs_[a].from;
            if (!near(from)) continue;
            walk_[a] = certificate_.cone_multiplier[from] + near_end_cost(from) + arcs_[a].cost;
        }
        for (std::size_t round = 0; round <= arcs_.size(); ++round) {
            bool shorter = false;
            for (std::size_t a = 0; a < arcs_.size(); ++a) {
                if (walk_[a] == kNone) continue;
                for (const auto& [b, turn] : successions_[a]) {
                    const double length = walk_[a] + turn + arcs_[b].cost;
                    if (!(length < walk_[b] - kShorter)) continue;
                    walk_[b] = length;
                    shorter = true;
                }
            }
            if (!shorter) return true;
        }
        return false;
    }

    /// The cost of the two cheapest walks to far cones within d_max of each other, minus the constant part of
    /// the relaxed constraints.
    [[nodiscard]] double combine() const {
        std::vector<double> best(scene_.cones.size(), kNone);
        for (std::size_t a = 0; a < arcs_.size(); ++a) {
            if (!near(arcs_[a].to)) best[arcs_[a].to] = std::min(best[arcs_[a].to], walk_[a]);
        }
        for (std::size_t f = 0; f < best.size(); ++f) {
            if (best[f] < kNone) best[f] += far_end_cost(f);
        }
        double pair = kNone;
        for (std::size_t f = 0; f < best.size(); ++f) {
            for (std::size_t g = f + 1; g < best.size(); ++g) {
                if ((position(f) - position(g)).norm() > p_.d_max + kTieTolerance) continue;
                pair = std::min(pair, best[f] + best[g]);
            }
        }
        double constant = -2.0 * certificate_.heading_multiplier;
        for (const double multiplier : certificate_.cone_multiplier) constant += multiplier;
        for (const BoundCertificate::Clique& clique : certificate_.cliques) constant += clique.multiplier;
        return pair - constant;
    }

    const Scene& scene_;
    const RldParameters& p_;
    const BoundCertificate& certificate_;
    Point heading_;
    std::vector<Arc> arcs_;
    std::vector<std::vector<Succession>> successions_;  ///< by arc
    std::vector<double> walk_;                          ///< the shortest walk that ends with the arc
    std::optional<LearnedReference<long double>> learned_;
    BoundVerdict verdict_;
};

}  // namespace

BoundVerdict verify_bound(const Scene& scene, const RldParameters& parameters,
                          const BoundCertificate& certificate) {
    return Verification(scene, parameters, certificate).run();
}

}  // namespace conelane
